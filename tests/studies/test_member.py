"""The folder of a run of a sweep: whatever its case reads is part of what it is a run of."""

import json
from pathlib import Path

import pytest

from fsi.case.load import case_data, load_case
from fsi.errors import InputError
from fsi.run_folder.kept import CASE
from fsi.studies.member import Request

SQUARE = "1,1\n-1,1\n-1,-1\n1,-1\n1.2,0\n"
SHAPE = 'shape = { kind = "spline", points = "parts/outline.csv" }'
BODIES = {
    "of a body": f'bodies = [{{ name = "a", position = [0.0, 0.0], {SHAPE} }}]',
    "of all bodies": f'bodies = [{{ name = "a", position = [0.0, 0.0] }}]\nbody_defaults = {{ {SHAPE} }}',
    "of a file of bodies": 'bodies_from = "parts/bodies.json"',
}


@pytest.mark.parametrize("bodies", BODIES.values(), ids=BODIES)
def test_a_changed_file_of_points_makes_another_case(bodies: str, tmp_path: Path) -> None:
    """Wherever the path stands, and wherever the sweep is started."""
    parts = tmp_path / "parts"
    parts.mkdir()
    (parts / "outline.csv").write_text(SQUARE)
    row = {"name": "a", "x": 0.0, "y": 0.0, "shape": {"kind": "spline", "points": "outline.csv"}}
    (parts / "bodies.json").write_text(json.dumps({"bodies": [row]}))
    path = tmp_path / "case.toml"
    domain = "domain = { lower = [-4.0, -4.0], upper = [4.0, 4.0] }"
    path.write_text(f'name = "a"\nfluid.viscosity = 1.0\n{domain}\n{bodies}\n')
    request = Request(tmp_path / "sweep" / "one", {}, case_data(path, ()), ("a.velocity.x",), motion=False)
    request.write()
    request.require_same()
    kept = request.folder / CASE
    assert str(tmp_path) not in kept.read_text()  # its paths are seen from its own folder
    assert load_case(kept) == load_case(path)
    (parts / "outline.csv").write_text(SQUARE.replace("1.2", "1.3"))
    with pytest.raises(InputError, match="holds a run of another case, of other files"):
        request.require_same()
