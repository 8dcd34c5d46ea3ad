"""The reduced model: bodies that feel drag and the lubrication of their gaps; NumPy and SciPy only."""
