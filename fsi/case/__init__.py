"""The case file: its sections as data, and how it is read."""
