"""A flow that is thrown away because of an error lets the program end."""

import subprocess
import sys
from pathlib import Path

THROWN_AWAY = """
from tests.flows import BOX, disc_over_plane, held, mesh, resting
from fsi.stokes.problem import StokesProblem
from fsi.stokes.solve import solve

def flows():
    q = disc_over_plane(1.0)
    yield solve(StokesProblem(mesh(BOX, q), BOX, q, held((1.0, 0.0, 0.0)), resting(BOX), viscosity=1.0))
    raise ArithmeticError("the second one fails")

one, other = flows()
"""


def test_an_error_after_a_flow_ends_the_program() -> None:
    """With the mesh's own communicator locked for Python objects it stays for ever."""
    command = [sys.executable, "-c", THROWN_AWAY]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, cwd=root)
    assert done.returncode == 1
    assert done.stderr.rstrip().endswith("ArithmeticError: the second one fails")
