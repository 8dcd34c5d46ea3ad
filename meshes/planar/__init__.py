"""Meshes of the plane and of the meridional plane: nodes on curves, then triangles."""
