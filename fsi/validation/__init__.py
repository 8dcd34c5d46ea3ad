"""The resolved model against exact solutions."""
