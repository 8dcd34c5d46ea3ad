"""Arrangements of discs and spheres: random, in arrays, rows, chains and columns. NumPy and SciPy only."""
