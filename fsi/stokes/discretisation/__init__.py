"""Taylor-Hood elements: forms, boundary data, constraints, matrices."""
