"""Pictures of fields, networks and spaces, with pyvista."""
