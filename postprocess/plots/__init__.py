"""Curves over time, gap or size, with matplotlib."""
