"""Shapes of walls in the plane, one file each; all files of this room are read when a case has one."""
