"""The drag that gives the reduced model a mean mobility: known, resolved, and in files that do not fit."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from fsi.arrays import Array
from fsi.calibration.drag import calibrated_drag, reduced_model
from fsi.case.case import Case
from fsi.case.drag_file import DragFile, read_drag_file, save_drag
from fsi.case.law_file import LawFile, SeriesSection, save_law
from fsi.case.load import parse_case
from fsi.case.reduced import LAW_KEYS
from fsi.cli.main import app
from fsi.errors import InputError
from fsi.observables.resistance import Modes, Resistance, ResistanceErrors
from fsi.reduced.model import ReducedModel

CHANNEL = {"lower": [0.0, 0.0], "upper": [6.0, 6.0], "periodic": ["x"]}
REDUCED = {"law": "exact", "shear_law": "exact", "rotation_law": "exact", "cutoff": 1.0}
PLACES = [[1.0, 2.0], [3.1, 2.3], [4.5, 4.9]]
SOURCE = Path("channel.toml")
# Of gaps to walls too, which have those between bodies unless a case says otherwise.
LAWS = dict.fromkeys(LAW_KEYS, "exact")


def channel(**reduced: Any) -> Case:
    """Three discs of radius 1 in 6 x 6: 0.2618 of it."""
    bodies = [{"name": f"b{k}", "radius": 1.0, "position": place} for k, place in enumerate(PLACES)]
    given = {key: value for key, value in (REDUCED | reduced).items() if value is not None}
    model = "reduced" if "drag" in given or "drag_from" in given else "resolved"
    return parse_case(
        {
            "name": "c",
            "model": model,
            "fluid": {"viscosity": 3.0},
            "domain": CHANNEL,
            "bodies": bodies,
            "reduced": given,
        }
    )


def as_resolved(R: Array, error: float = 0.0) -> tuple[Resistance, ResistanceErrors]:
    """R and an error of each entry of its inverse as if they had been computed."""
    none = Modes((), (), np.ones(len(R)))
    found = Resistance(none, R, np.linalg.inv(R), np.linalg.eigvalsh(R), {}, 0, 0, {})
    return found, ResistanceErrors(0.0 * R, np.full_like(R, error), 0.0)


def model_with(drag: float) -> tuple[ReducedModel, Array]:
    """A model, and its resistance with this drag."""
    model = reduced_model(channel())
    zeta = model.zeta * np.where(np.arange(3) < 2, drag, 1.0)
    return model, model.resistance(model.case.configuration(), 0.0).toarray() + np.diag(zeta.ravel())


@pytest.mark.parametrize("drag", [0.3, 9.3, 400.0])
def test_a_known_drag_is_found_again(drag: float) -> None:
    """Over mu V, mu = 3; the mean of the diagonal of R instead would give tens of times more."""
    model, R = model_with(drag)
    found = calibrated_drag(model, *as_resolved(R), SOURCE)
    assert found.drag == pytest.approx(drag, rel=1e-9)
    assert found.fraction == pytest.approx(3.0 * np.pi / 36.0)
    assert (found.shape, found.cutoff, found.laws) == ("discs", 1.0, LAWS)
    assert found.digests == {}  # names tell all


def test_its_error_is_that_of_the_mobility() -> None:
    """A mobility that is larger by its error gives a drag that is smaller by the error of the file."""
    model, R = model_with(9.0)
    error = 1e-6 * float(np.linalg.inv(R)[0, 0])
    found = calibrated_drag(model, *as_resolved(R, error), SOURCE)
    resistance, errors = as_resolved(R)
    assert resistance.mobility is not None
    more = calibrated_drag(model, replace(resistance, mobility=resistance.mobility + error), errors, SOURCE)
    assert found.drag - more.drag == pytest.approx(found.error, rel=1e-3)


def test_pairs_that_resist_too_much_are_named() -> None:
    model, R = model_with(1e-9)
    with pytest.raises(InputError, match=r"reduced\.cutoff = 1\.0: pairs alone resist more .*; shorten it"):
        calibrated_drag(model, *as_resolved(0.9 * R), SOURCE)


def test_the_command_gives_the_model_the_mobility_of_the_flow(tmp_path: Path) -> None:
    """The mean of (zeta + R_lub)^-1 over translations, with the drag of the file, is that of R^-1."""
    case, drag, R = (tmp_path / name for name in ("case.toml", "drag.toml", "R.json"))
    case.write_text(channel().as_toml())
    result = CliRunner().invoke(app, ["resistance", str(case), "-o", str(R), "--drag", str(drag)])
    assert result.exit_code == 0, result.output
    mobility = np.diag(json.loads(R.read_text())["mobility"]).reshape(3, 3)[:, :2].mean()
    model = ReducedModel(channel(drag_from=str(drag)))
    ours = np.linalg.inv(
        model.resistance(model.case.configuration(), 0.0).toarray() + np.diag(model.zeta.ravel())
    )
    assert np.diag(ours).reshape(3, 3)[:, :2].mean() == pytest.approx(mobility, rel=1e-9)
    assert f"drag = {read_drag_file(drag).drag:.6g}" in result.output
    assert 3.0 < read_drag_file(drag).drag < 30.0


FILE = DragFile(
    drag=8.0, error=1e-4, shape="discs", fraction=0.26, cutoff=1.0, laws=LAWS, digests={}
)  # fmt: skip


@pytest.mark.parametrize(
    ("change", "reduced", "message"),
    [
        ({}, {"drag": 8.0}, r'drag_from = ".*": there is reduced\.drag = 8 too; drop one'),
        ({"shape": "spheres"}, {}, "a drag of spheres, but the case has discs; calibrate one"),
        ({"fraction": 0.24}, {}, r"found where bodies are 0\.24 of the domain, but here they are 0\.262"),
        ({}, {"cutoff": 0.5}, r"found with reduced\.cutoff = 1\.0 mean radii, not 0\.5"),
        ({"cutoff": None}, {}, r"found with reduced\.cutoff = None"),
        ({}, {"rotation_law": "leading"}, r"with reduced\.rotation_law = exact, not leading; give that"),
        ({}, {"wall_law": "leading"}, r"with reduced\.wall_law = exact, not leading; give that"),
        ({}, {"rotation_law": None}, r"with reduced\.rotation_law = exact, not none; give that"),
    ],
)
def test_a_drag_of_something_else_is_refused(
    change: dict[str, Any], reduced: dict[str, Any], message: str, tmp_path: Path
) -> None:
    path = tmp_path / "drag.toml"
    save_drag(path, FILE.model_copy(update=change))
    with pytest.raises(InputError, match=message):
        channel(drag_from=str(path), **reduced)


def test_a_default_that_is_written_out_is_the_same_law(tmp_path: Path) -> None:
    save_drag(tmp_path / "drag.toml", FILE)
    case = channel(drag_from=str(tmp_path / "drag.toml"), wall_law="exact", wall_shear_law="exact")
    assert case.drag == 8.0


def law_in(folder: Path, c: float, name: str = "law.toml", **more: Any) -> str:
    """The path of a file with the law K = c s^(-3/2) of equal discs."""
    folder.mkdir(exist_ok=True)
    series = SeriesSection(powers=(-1.5,), logs=(False,), coefficients=(c,), covariance=((1e-8,),))
    common: dict[str, Any] = {"form": "series", "shape": "discs", "ratio": 1.0}
    common |= {"viscosity": 1.0, "range": (1e-4, 9.0)}
    save_law(folder / name, LawFile(**(common | more), series=series))
    return str(folder / name)


def test_a_law_is_told_by_what_it_says_and_not_by_the_name_of_its_file(tmp_path: Path) -> None:
    """Calibrations all write law.toml; another file of the same law, from wherever, is as good."""
    one, other = law_in(tmp_path / "a", 13.3), law_in(tmp_path / "b", 6.6)
    plain = {"shear_law": None, "rotation_law": None, "wall_law": "exact"}
    model = reduced_model(channel(law=one, **plain))
    R = model.resistance(model.case.configuration(), 0.0).toarray() + np.diag(9.0 * model.zeta.ravel())
    found, path = calibrated_drag(model, *as_resolved(R), SOURCE), tmp_path / "drag.toml"
    assert found.laws == {"law": "law.toml", "wall_law": "exact"}
    save_drag(path, found)
    same = law_in(tmp_path / "c", 13.3, "same.toml", viscosity=2.0, source={"case": "another"})
    for law in (one, same):
        assert channel(law=law, **plain, drag_from=str(path)).drag == found.drag
    with pytest.raises(
        InputError, match=r"with reduced\.law = law\.toml \(\w{8}\), not law\.toml \(\w{8}\);"
    ):
        channel(law=other, **plain, drag_from=str(path))


def test_a_drag_file_that_does_not_tell_its_laws_is_to_be_made_anew(tmp_path: Path) -> None:
    path = tmp_path / "drag.toml"
    save_drag(path, FILE)
    path.write_text(path.read_text().replace("[digests]", ""))
    with pytest.raises(
        InputError, match=r"drag\.toml: digests: missing; .* `fsi resistance CASE --drag FILE`"
    ):
        channel(drag_from=str(path))


def test_a_drag_file_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"there is no such file; `fsi resistance CASE --drag FILE` writes one"
    ):
        channel(drag_from=str(tmp_path / "none.toml"))
    with pytest.raises(InputError, match="is a folder; `fsi resistance CASE --drag FILE` writes one"):
        channel(drag_from=str(tmp_path))
    (tmp_path / "drag.toml").write_text("drag = -1.0")
    with pytest.raises(InputError, match=r"drag\.toml: .*drag = -1\.0: .*greater than 0"):
        channel(drag_from=str(tmp_path / "drag.toml"))
