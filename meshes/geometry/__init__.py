"""What encloses the fluid: boxes, planes, round containers, periodic domains."""
