"""A run folder read back: its tables, fields and values at points."""
