"""Lubrication: the exact forces at small gaps, and the laws built on them."""
