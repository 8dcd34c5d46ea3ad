"""Motion in time: the state, the schemes, the steppers, and what bounds a step."""
