"""Shapes of walls in the plane, one file each; a file has the name of its word."""
