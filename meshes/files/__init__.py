"""Mesh files: written, read, recovered from a run."""
