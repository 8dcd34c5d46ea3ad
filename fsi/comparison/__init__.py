"""One case at several levels: the motion that each gives, and the velocities at one instant."""
