"""Pictures of macroscopic runs: their profiles, with matplotlib alone."""

from __future__ import annotations

import sys
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread
from PIL.GifImagePlugin import GifImageFile

import fsi
from fsi.errors import InputError
from fsi.postprocess.plots.trajectories import (
    plot_paths,
    profile_ends,
    profile_scales,
    space_time_figure,
    vacuum,
)
from fsi.postprocess.render import canvas
from fsi.postprocess.render.profile import ProfileArtist, profile_figure
from fsi.postprocess.render.render import render_run
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.run import Run
from tests.commands import fsi_command

CASE = Path(__file__).parents[3] / "cases" / "macroscopic" / "blocks.toml"


@pytest.fixture
def blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Two blocks that move towards each other, at t = 0, 0.25 and 0.5, where nothing draws with OpenGL."""
    monkeypatch.setattr(canvas, "_DRAW", "raise SystemExit(1)")
    overrides = ("--set", "macroscopic.parcels=40", "--set", "time.end=0.5")
    assert fsi_command("run", CASE, "-o", tmp_path / "run", *overrides) == 0
    return fsi.open_run(tmp_path / "run")


def test_a_figure_shows_where_the_blocks_are(blocks: Run) -> None:
    """At t = 0.5 they lie at [-1.5, -0.5] and [0.75, 1.75], with u = 1 and -1/2, and no memory.

    Nothing moves in between, where u had a line of 20 parcels' length and more.
    """
    profile = ProfileArtist(blocks, Choice())._read(blocks.step(None, "profile"))
    ends = dict.fromkeys(profile, (-2.0, 2.0))
    figure = profile_figure("t = 0.5", profile, ends, Choice(size=300))
    (x, rho), (_, u), (_, gamma) = (np.asarray(axes.lines[0].get_data(), dtype=float) for axes in figure.axes)
    np.testing.assert_allclose(x, np.append(np.linspace(-1.475, -0.525, 20), np.linspace(0.775, 1.725, 20)))
    np.testing.assert_allclose(u, np.repeat([1.0, np.nan, -0.5], [20, 1, 20]))
    np.testing.assert_allclose(gamma, np.repeat([0.0, np.nan, 0.0], [20, 1, 20]), atol=1e-12)
    assert rho[2:18] == pytest.approx(1.0)


@pytest.mark.parametrize("a", [1e-9, 1.0, 1e12])
def test_axes_are_the_same_in_any_unit_of_length(a: float, tmp_path: Path) -> None:
    """Matter of density 1/2 that u = -x brings together at t = 1/2, with gamma = (x^2 - a^2 / 4) then.

    Its mass is a, and gamma has the unit a^2: 1e-18 is no rounding then, and 1e9 is.
    """
    block = {"left": -a, "right": a, "density": 0.5, "initial_velocity": "-x"}
    matter, line = {"parcels": 40, "blocks": [block]}, {"shape": "unbounded"}
    case = fsi.make_case(
        name="t", model="macroscopic", domain=line, macroscopic=matter,
        time={"end": 1.0, "step": 0.01}, output={"interval": 0.25},
    )  # fmt: skip
    fsi.run(case, tmp_path / "run")
    artist = ProfileArtist(fsi.open_run(tmp_path / "run"), Choice())
    scales, profiles = profile_scales(artist.run), [artist._read(step) for step in (25, 100)]
    pairs = ((name, of) for of in profiles for name in ("x", "rho", "u", "gamma"))
    widths = np.array([np.diff(profile_ends(of[name], scales[name], 0.05))[0] for name, of in pairs]).reshape(
        2, 4
    )
    unit = np.array([a, 1.0, a, a**2])
    # Over 40 parcels; u and gamma that are constant have their scale for width.
    expected = [[1.1 * 0.75 * 1.95, 1.0, 1.1 * 1.95, 0.975**2], [1.1 * 0.975, 1.0, 1.95 / 2, 1.1 * 0.25]]
    np.testing.assert_allclose(widths / unit, expected, rtol=0.05)


def test_pictures_and_animations(blocks: Run) -> None:
    picture = imread(render_run(blocks, blocks.path / "a.png", Choice(size=300), time=0.2))
    one = imread(render_run(blocks, blocks.path / "u.png", Choice("u", span=(-1.0, 1.0), size=300)))
    assert picture.shape[1] == one.shape[1] == 300
    assert picture.shape[0] > one.shape[0]
    with GifImageFile(render_run(blocks, blocks.path / "all.gif", Choice(size=100))) as movie:
        assert movie.n_frames == 3


class Terminal(StringIO):
    def isatty(self) -> bool:
        return True


def test_an_animation_says_on_a_terminal_how_far_it_is(blocks: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm")
    for stderr, said in ((Terminal(), True), (StringIO(), False)):
        monkeypatch.setattr(sys, "stderr", stderr)
        render_run(blocks, blocks.path / "all.gif", Choice(size=100))
        assert ("3 of 3 pictures" in stderr.getvalue()) == said
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    render_run(blocks, blocks.path / "a.png", Choice(size=100))
    assert not terminal.getvalue()


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        (Choice("speed"), "--field speed: give one of rho, u, gamma"),
        (Choice(gap="a,b"), "--gap a,b: there are no bodies in this run"),
    ],
)
def test_impossible_choices(blocks: Run, choice: Choice, message: str) -> None:
    with pytest.raises(InputError, match=message):
        render_run(blocks, blocks.path / "a.png", choice)


def test_what_has_no_bodies_has_no_trajectories(blocks: Run) -> None:
    with pytest.raises(InputError, match=r"no bodies, and so no trajectories; drop --paths or --relative$"):
        plot_paths(blocks, blocks.path / "paths.png")


def test_space_and_time_of_a_macroscopic_run(blocks: Run) -> None:
    """At the three times; between the blocks there is no matter, and nothing that moves.

    The parcels beside the vacuum have half of it each: at last rho = 0.05 / 0.675, which was drawn across.
    """
    figure = space_time_figure(blocks, Figure())
    density, velocity = (axes.collections[0] for axes in figure.axes[:2])
    rho, u = (
        np.ma.filled(np.ma.asarray(each.get_array()), np.nan).reshape(3, -1) for each in (density, velocity)
    )
    assert rho[:, [5, 15, 25, 35]] == pytest.approx(1.0)
    assert density.get_clim() == pytest.approx((0.0, 1.0))
    for values in (*rho, *u):
        np.testing.assert_array_equal(np.flatnonzero(np.isnan(values)), [19, 20])
    np.testing.assert_allclose(u[:, [5, 35]], np.tile([1.0, -0.5], (3, 1)))
    assert fsi_command("plot", blocks.path, "-o", blocks.path / "st.svg") == 0
    assert (blocks.path / "st.svg").read_bytes().startswith(b"<?xml")


@pytest.mark.parametrize(
    ("apart", "empty"),
    [
        ([1.0, 1.0, 3.0, 1.0], [2]),
        ([1.0, 1.0, 13.0, 25.0, 25.0], []),  # matter of density 0.04 beside dense matter
        ([1.0, 1.0, 60.0, 25.0, 25.0], [2]),
        ([7.0], []),
    ],
)
def test_vacuum_is_wider_than_what_is_on_either_side(apart: list[float], empty: list[int]) -> None:
    """Not where parcels are twenty times as far apart as others: 3 was matter, 25 was vacuum."""
    x = np.cumsum([0.0, *apart])
    np.testing.assert_array_equal(np.flatnonzero(vacuum(x)), empty)


def test_profiles_that_were_changed_are_refused(blocks: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    table = blocks.table("profiles")
    for column, row, value in (("x", 3, 9.0), ("t", 0, 0.3), ("step", 1, 7)):
        changed = table.copy()
        changed.loc[row, column] = value
        monkeypatch.setattr(Run, "table", lambda *_, table=changed: table)
        with pytest.raises(InputError, match=r"profiles\.csv: x and t do not ascend in it"):
            space_time_figure(blocks, Figure())
