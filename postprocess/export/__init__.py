"""A run's meshes and fields in other forms."""
