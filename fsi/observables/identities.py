"""The identities that every resolved solution satisfies: columns of steps.csv, what they say, their bound."""

BOUND = 1e-8  # of each relative defect; a solution beyond it is refused
IDENTITIES = {
    "power": "dissipation = power of the loads and walls",
    "momentum": "forces of bodies and walls sum to zero",
    "angular_momentum": "torques of bodies and walls sum to zero",
    "balance": "computed loads on free bodies = given loads",
    "net_flux": "no net flux through the boundary",
    "residual": "residual of the linear system",
}
