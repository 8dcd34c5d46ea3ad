"""Forces on bodies besides those of the fluid; all files of this room are read when a case has one."""
