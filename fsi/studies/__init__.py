"""Studies that solve one case for many values of a key."""
