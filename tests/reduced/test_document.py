"""What docs/reduced.md says that `fsi compare` prints is what it prints."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from fsi.models import make_model
from tests.reduced_data import reduced_case
from tests.test_manual_output import call, require_printed

TEXT = (Path(__file__).parents[2] / "docs" / "reduced.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(("shape", "power"), [("discs", 1), ("spheres", 2)])
def test_what_the_law_of_the_slides_takes_in_other_units(shape: str, power: int) -> None:
    """As "Laws" says. The pulled one of two has U = (1 + k)/(1 + 2 k)/zeta, k = kappa/zeta.

    With lengths 1e-6 times the numbers alone k is larger: in the plane 0.500000025 for 0.5238, of drag 1.
    """

    def pulled(c: float, viscosity: float, drag: float) -> float:
        bodies = [
            {"name": name, "radius": c, "position": [*zero, x * c], "force": [*zero, F]}
            for name, x, F in (("a", 0.0, 1.0), ("b", 2.1, 0.0))
        ]
        reduced = {"law": "slides", "drag": drag}
        fluid, geometry = {"viscosity": viscosity}, "planar" if shape == "discs" else "axisymmetric"
        unbounded = {"shape": "unbounded"}
        case = reduced_case(bodies, reduced, fluid=fluid, geometry=geometry, domain=unbounded)
        return float(make_model(case)(case.configuration(), 0.0).U[0, 1])

    zero, c = [0.0], 1e-6
    zeta = c ** (power - 1)  # mu drag of discs, mu a drag of spheres
    assert pulled(1.0, 1.0, 1.0) == pytest.approx(11.0 / 21.0, rel=1e-12)
    assert pulled(c, c**power, c**-power) == pytest.approx(11.0 / 21.0 / zeta, rel=1e-12)
    k = 10.0 / c**power
    assert pulled(c, 1.0, 1.0) == pytest.approx((1.0 + k) / (1.0 + 2.0 * k) / zeta, rel=1e-12)


def test_the_table_of_levels(tmp_path: Path) -> None:
    """All but the seconds, in the last column."""
    command, table = re.findall(r"`(fsi compare [^`]*)`[^\n]*\n(?:[^\n]+\n)*\n((?:    [^\n]+\n)+)", TEXT)[0]
    rows = [line.rsplit(maxsplit=1)[0] for line in table.splitlines()[1:]]
    assert [row.split()[0] for row in rows] == ["resolved", "pores", "reduced"]
    require_printed(rows, call(" ".join(command.split()), tmp_path))
