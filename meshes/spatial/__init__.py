"""Meshes of space: sizes, prisms in gaps, tetrahedra."""
