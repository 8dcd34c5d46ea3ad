"""Body-fitted meshes of the fluid domain: geometry in, `FluidMesh` out; no physics here."""
