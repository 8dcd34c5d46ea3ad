"""Calibration: resolved resistances of a pair at many gaps, and the lubrication law fitted to them."""
