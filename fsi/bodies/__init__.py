"""Rigid bodies: where they are, how near to each other, what forces act between them."""
