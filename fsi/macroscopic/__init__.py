"""The macroscopic gluey model on a line: a pressureless gas with density at most 1 and a memory."""
