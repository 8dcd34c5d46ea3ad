"""The vanishing-viscosity limit: bodies that stick, and come apart when pulled as long as they were pushed."""
