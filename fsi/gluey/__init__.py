"""The vanishing-viscosity limit: bodies that stick until they are pulled as long as they were pushed."""
