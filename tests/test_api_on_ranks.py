"""What `import fsi` offers on several ranks."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from tests.cli.test_commands import call
from tests.ranks import needs_mpi, python_on

ROOT = Path(__file__).parents[1]
SMALL = ["discretisation.degree=2", "discretisation.cells_per_circle=12", "discretisation.growth=1.0"]


@needs_mpi
@pytest.mark.mpi
def test_it_works_on_several_ranks(tmp_path: Path) -> None:
    """The force on a disc, a point of the flow and a run are those of one process."""
    script = tmp_path / "script.py"
    script.write_text(
        f"import fsi, fsi.parallel as parallel\n"
        f"case = fsi.load_case({str(ROOT / 'cases' / 'disc_in_box.toml')!r}, {SMALL})\n"
        "solution = fsi.solve(case)\n"
        "u, p = solution.evaluate([[0.0, 4.0]])\n"
        "small = fsi.load_case(" + repr(str(ROOT / "cases" / "gluey" / "two_discs.toml")) + ", "
        "['time.end=0.1', 'time.step=0.05'])\n"
        f"steps = len(fsi.run(small, {str(tmp_path / 'run')!r} + str(parallel.size())).steps)\n"
        "if parallel.is_root():\n"
        "    print(solution['disc'].force[1], u[0, 1], p[0], steps)\n"
    )
    alone = call(sys.executable, str(script))
    several = call(*python_on(2), str(script))
    assert alone.returncode == several.returncode == 0, several.stderr
    np.testing.assert_allclose(
        [float(word) for word in several.stdout.split()],
        [float(word) for word in alone.stdout.split()],
        rtol=1e-9,
    )


DIFFERENT = """
import sys
import numpy as np
import fsi, fsi.parallel as parallel

def refused(what, ask):
    try:
        ask()
    except fsi.InputError as error:
        said = parallel.gather(str(error))
        assert said == 2 * [f"{what}: not the same on all ranks; give the same on each"], said
    else:
        raise AssertionError(what)

box, own, out = sys.argv[1], parallel.rank(), sys.argv[2]
small = sys.argv[3:]
case = fsi.load_case(box, small)
solution = fsi.solve(case)
x = np.column_stack([np.linspace(-3.0, 3.0, 40), np.full(40, 4.0)])
for points in (x[own::2], x[: 20 + own], x if own else []):
    refused("points", lambda: solution.evaluate(points))
    refused("points", lambda: solution.velocity(points))
other = fsi.load_case(box, [*small, f"fluid.viscosity={1 + own}"])
refused("case", lambda: fsi.solve(other))
refused("case", lambda: fsi.run(other, out))
refused("case", lambda: fsi.calibrate(other, out))
refused("folder", lambda: fsi.run(case, f"{out}{own}"))
refused("folder", lambda: fsi.resume(f"{out}{own}"))
refused("folder", lambda: solution.write(f"{out}{own}"))
assert not np.isnan(solution.velocity(x)).any()
if parallel.is_root():
    print("done")
"""


@needs_mpi
@pytest.mark.mpi
def test_what_differs_between_ranks_is_refused_on_all_of_them(tmp_path: Path) -> None:
    """Points were matched by their places: of halves the values were those of the other rank's points."""
    box = ROOT / "cases" / "disc_in_box.toml"
    done = call(*python_on(2), "-c", DIFFERENT, str(box), str(tmp_path / "out"), *SMALL, timeout=120.0)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "done\n"
    assert not list(tmp_path.iterdir())
