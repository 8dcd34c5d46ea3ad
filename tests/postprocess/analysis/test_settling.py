"""The comparison with the exact settling law, on histories whose error is known."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from numpy.typing import NDArray

from fsi.errors import InputError
from fsi.lubrication.exact import settling_time
from fsi.postprocess.analysis.settling import chosen_rows, read_settling
from fsi.postprocess.run.run import open_run
from tests.commands import fsi_command

Fill = Callable[[list[float], list[float]], Path]

GAPS = np.geomspace(0.2, 1e-4, 40)  # the case of conftest starts at 1.2 - 1


def exact_times(gaps: NDArray[np.float64]) -> list[float]:
    """When the disc of the case has these gaps: mu = 1, a = 1, F_y = -1."""
    return [float(t) for t in settling_time(gaps, 0.2, 1.0, 1.0, -1.0)]


def test_exact_history_has_no_difference(settling_run: Fill) -> None:
    run = settling_run(exact_times(GAPS), (1.0 + GAPS).tolist())
    history = read_settling(open_run(run))
    # Heights near 1 round gaps of 1e-4 to 1e-12 relative; a wrong power of the gap would show at once.
    np.testing.assert_allclose(history.difference, 0.0, atol=5e-12)


def test_table_and_plot(settling_run: Fill, capsys: pytest.CaptureFixture[str]) -> None:
    wrong = np.where(np.arange(40) == 17, 1.0 + 3e-3, 1.0)
    run = settling_run(exact_times(GAPS), (1.0 + GAPS * wrong).tolist())
    assert fsi_command("analyse", "settling", run) == 0
    printed = capsys.readouterr().out
    assert "relative difference" in printed
    assert "disc settling onto a plane" in printed
    worst = next(line for line in printed.splitlines() if f"{exact_times(GAPS)[17]:.6g}" in line)
    assert "+3.0e-03" in worst
    assert worst.split()[3:6:2] == [
        f"{GAPS[17] * 1.003:.3e}",
        f"{GAPS[17]:.3e}",
    ]  # digits that all machines agree on
    assert (run / "settling.png").read_bytes().startswith(b"\x89PNG")


def test_a_sphere_is_called_one(
    settling_run: Fill, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the table, the picture, and what is said where there is no exact law."""
    run, titles = settling_run([0.0, 1.0], [1.2, 1.19]), list[str]()
    case = (run / "case.toml").read_text().replace('"planar"', '"axisymmetric"')
    (run / "case.toml").write_text(case)
    draw = Axes.set

    def note(axes: Axes, **given: object) -> object:
        titles.extend(str(value) for name, value in given.items() if name == "title")
        return draw(axes, **given)

    monkeypatch.setattr(Axes, "set", note)
    assert fsi_command("analyse", "settling", run) == 0
    printed = capsys.readouterr().out
    assert "sphere settling onto a plane" in printed
    assert titles == ["sphere settling onto a plane under a constant force"]
    (run / "case.toml").write_text(case.replace("force = [0.0, -1.0]", "velocity = [0.0, -1.0]"))
    with pytest.raises(InputError, match="a sphere that settles has"):
        read_settling(open_run(run))


def test_a_sphere_in_space_settles_as_on_an_axis(settling_run: Fill) -> None:
    """Its height is z; where it stands beside that makes no difference."""
    t, z = [0.0, 1.0, 2.0], [1.2, 1.19, 1.18]
    folder = settling_run(t, z)
    case = (folder / "case.toml").read_text()
    (folder / "case.toml").write_text(case.replace('"planar"', '"axisymmetric"'))
    on_axis = read_settling(open_run(folder))
    in_space = case.replace('"planar"', '"spatial"').replace("= [0.0, ", "= [0.0, 0.0, ")
    (folder / "case.toml").write_text(in_space)
    rows = [f"{n},{t[n]},disc,0.0,0.0,{z[n]}" for n in range(3)]
    (folder / "bodies.csv").write_text("\n".join(["step,t,body,x,y,z", *rows]) + "\n")
    found = read_settling(open_run(folder))
    assert found.body == "sphere"
    np.testing.assert_allclose(found.gap, [0.2, 0.19, 0.18], rtol=1e-12)
    np.testing.assert_array_equal(found.exact, on_axis.exact)


def test_rows_spread_over_the_logarithm_of_the_gap() -> None:
    rows = chosen_rows(np.geomspace(1.0, 1e-4, 200))
    assert len(rows) == 12
    assert (rows[0], rows[-1]) == (0, 199)
    assert np.ptp(np.diff(rows)) <= 1
    assert list(chosen_rows(np.array([1.0, 0.5]))) == [0, 1]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("force = [0.0, -1.0]", "force = [1.0, -1.0]", "bodies.0.force = "),
        ("force = [0.0, -1.0]", "", "bodies.0.force = "),
        (
            "force = [0.0, -1.0]",
            "force = [0.0, {times = [0.0, 1.0], values = [-1.0, 0.0]}]",
            "bodies.0.force = ",
        ),
        ("force = [0.0, -1.0]", "velocity = [0.0, -1.0]", "bodies.0.velocity = "),
        ("[time]", "mass = 1.0\nmoment_of_inertia = 1.0\n[time]", "bodies.0.mass = "),
        (
            "[time]",
            '[[bodies]]\nname = "second"\nradius = 0.5\nposition = [3.0, 3.0]\n[time]',
            "bodies: there are 2",
        ),
        ("[time]", "slip_length = 0.1\n[time]", "bodies.0.slip_length = 0.1"),
        ("[time]", "surface_velocity = [0.0, 1.0]\n[time]", "bodies.0.surface_velocity = [0.0, 1.0]"),
        (
            "[time]",
            '[[forces]]\nkind = "gravity"\nacceleration = [0.0, -9.0]\ndensity_difference = 1.0\n[time]',
            'forces.0 = {kind = "gravity"',
        ),
        (
            "[time]",
            '[[forces]]\nkind = "repulsion"\nlaw = "exponential"\nwalls = true\nstrength = 1.0\n'
            "length = 0.1\ncutoff = 1.0\n[time]",
            'forces.0 = {kind = "repulsion"',
        ),
        (
            "domain.radius = 6.0",
            "domain.radius = 6.0\ndomain.walls.plane = {slip_length = 0.2}",
            "domain.walls.plane = {slip_length = 0.2}",
        ),
        (
            "domain.radius = 6.0",
            'domain.radius = 6.0\ndomain.profiles.plane = {kind = "wave", height = -0.1, length = 1.0, '
            "number = 2, start = -1.0}",
            "domain.profiles",
        ),
        ("domain.radius = 6.0", "domain.radius = 6.0\ndomain.walls.far = {shear = 1.0}", "domain.walls.far"),
        (
            'domain.shape = "half-plane"\ndomain.radius = 6.0',
            "domain.lower = [-6.0, 0.0]\ndomain.upper = [6.0, 6.0]",
            'domain.shape = "box"',
        ),
    ],
)
def test_other_cases_are_refused_in_one_line(
    run: Path, capfd: pytest.CaptureFixture[str], old: str, new: str, message: str
) -> None:
    case = run / "case.toml"
    assert old in case.read_text()
    case.write_text(case.read_text().replace(old, new))
    assert fsi_command("analyse", "settling", run) == 2
    error = capfd.readouterr().err
    assert error.startswith(f"error: {message}")
    assert error.count("\n") == 1
    assert not (run / "settling.png").exists()


def test_a_gluey_run_is_refused(run: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """It has no viscous fluid, though all else is as the exact law wants it."""
    text = (run / "case.toml").read_text().replace("[time]", "[time]\nstep = 0.1")
    (run / "case.toml").write_text(f'model = "gluey"\n{text}')
    assert fsi_command("analyse", "settling", run) == 2
    said = capfd.readouterr().err
    assert said.startswith('error: model = "gluey": has no viscous fluid')
    assert said.endswith("; give a run of resolved, pores or reduced\n")
    assert not (run / "settling.png").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [("", "no rows yet"), ("step,t,body,y\n1,2.0,disc,ab\n", "broken"), ("step,t,body,y\n1,2.0\n", "broken")],
)
def test_broken_tables(run: Path, text: str, message: str) -> None:
    (run / "bodies.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        read_settling(open_run(run))
