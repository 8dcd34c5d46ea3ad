"""Meshes that move with the bodies."""
