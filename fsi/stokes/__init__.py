"""The resolved model: Stokes flow around rigid bodies, by finite elements (dolfinx)."""
