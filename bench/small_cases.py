"""Small cases as the text of their files, for benches that launch commands: on ranks, and to be killed."""

# Of meshes, as coarse as are valid.
SIZES = """
[discretisation]
degree = 2
cells_per_circle = 10
cells_per_gap = 0.5
growth = 1.0
"""
SIZES_IN_SPACE = SIZES.replace("cells_per_circle = 10", "cells_per_circle = 6")

ONE_DISC = f"""
name = "discs"
[fluid]
viscosity = 1.0
[domain]
lower = [-4.0, 0.0]
upper = [4.0, 6.0]
[[bodies]]
name = "free"
radius = 1.0
position = [-1.5, 1.5]
force = [0.0, -1.0]
{SIZES}"""
TWO_DISCS = f"""
{ONE_DISC}
[[bodies]]
name = "held"
radius = 1.0
position = [1.5, 1.5]
velocity = [0.0, 0.0]
"""
CHANNEL = f"""
name = "channel"
[fluid]
viscosity = 1.0
[domain]
periodic = ["x"]
lower = [0.0, -2.6]
upper = [5.0, 2.6]
net_flux = 1.0
walls.top = [1.0, 0.0]
[[bodies]]
name = "disc"
radius = 1.0
position = [0.4, -1.3]
{SIZES}"""
BALL = """
name = "sphere in a box"
geometry = "spatial"
[fluid]
viscosity = 1.0
[domain]
lower = [-3.0, -3.0, 0.0]
upper = [3.0, 3.0, 6.0]
[[bodies]]
name = "sphere"
radius = 1.0
position = [0.0, 0.0, 2.0]
"""
FALLING_DISC = f"""
name = "disc in a box"
[fluid]
viscosity = 1.0
[domain]
lower = [-3.0, 0.0]
upper = [3.0, 5.0]
[[bodies]]
name = "disc"
radius = 1.0
position = [-0.5, 2.5]
force = [0.0, -20.0]
{SIZES}[time]
end = 0.4
first_step = 0.05
tolerance = 1e-2
remesh = "when-needed"
[output]
interval = 0.1
"""
FALLING_BALL = f"""
{BALL}
force = [0.0, 0.0, -2.0]
{SIZES_IN_SPACE}
[time]
end = 0.2
first_step = 0.05
tolerance = 1e-1
remesh = "when-needed"
[output]
interval = 0.1
"""
HELD_BALL = f"""
{BALL}
velocity = [0.0, 0.0, -1.0]
{SIZES_IN_SPACE}
solver = "iterative"
"""
CALIBRATED = f"""
name = "disc towards a plane"
[fluid]
viscosity = 1.0
[domain]
shape = "half-plane"
radius = 100.0
[[bodies]]
name = "disc"
radius = 1.0
position = [0.0, 2.0]
{SIZES}[calibration]
pair = ["disc", "plane"]
range = [0.1, 1.0]
samples = 6
held_out = 0
"""
TWO_REDUCED = """
name = "reduced"
model = "reduced"
[fluid]
viscosity = 1.0
[domain]
lower = [-4.0, 0.0]
upper = [4.0, 8.0]
[[bodies]]
name = "low"
radius = 1.0
position = [0.0, 2.0]
force = [0.0, -10.0]
[[bodies]]
name = "high"
radius = 1.0
position = [0.5, 5.0]
force = [0.0, -20.0]
[reduced]
law = "exact"
drag = 12.0
[time]
end = 1.0
tolerance = 1e-5
[output]
interval = 0.05
"""
