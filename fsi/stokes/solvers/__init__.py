"""Linear solvers of the saddle-point system: direct, iterative, with or without multipliers."""
