"""This machine: what it holds, what it keeps of freed memory, and loops in its own code."""
