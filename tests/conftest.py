"""For all tests: load the project before NumPy, as the command line does, so that it runs on one thread."""

import os
import sys
from collections.abc import Generator
from pathlib import Path

import pytest
from hypothesis import settings

import fsi as fsi
from fsi.errors import InputError
from tests.pictures import NO_PICTURES

# A busy machine is not a defect: nothing is judged by the clock.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Keep what pytest makes of the tests, also under PYTHONDONTWRITEBYTECODE: on each worker 4 s of CPU."""
    usual, sys.dont_write_bytecode = sys.dont_write_bytecode, False
    try:
        return (yield)
    finally:
        sys.dont_write_bytecode = usual


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say loudly that pictures were not tested: without OpenGL all of these tests are skipped."""
    skipped = terminalreporter.stats.get("skipped", [])
    count = sum(NO_PICTURES in str(report.longrepr) for report in skipped)
    if count:
        terminalreporter.section(NO_PICTURES.upper(), red=True, bold=True)
        terminalreporter.line(
            f"{count} tests draw pictures, and this machine has no off-screen OpenGL:", red=True
        )
        terminalreporter.line("apt-get install -y libegl1 libgl1, or set CI=1 to let them fail", red=True)


@pytest.fixture(scope="session")
def can_draw() -> None:
    """Skips where no picture can be drawn, which the end of the session says; in CI that is a failure."""
    from fsi.postprocess.render import canvas  # loads pyvista, which few tests need

    try:
        canvas.require_opengl()
    except InputError as error:
        if os.environ.get("CI"):
            pytest.fail(f"{NO_PICTURES}: {error}")
        pytest.skip(f"{NO_PICTURES}: {error}")


@pytest.fixture
def drawing(can_draw: None, monkeypatch: pytest.MonkeyPatch) -> None:  # noqa: ARG001
    """For what draws: a child process was asked once, not again before each picture, half a second each.

    Planes in space have half as many points along each side.
    """
    monkeypatch.setattr("fsi.postprocess.render.canvas._draws", lambda _: True)
    monkeypatch.setattr("fsi.postprocess.render.cut._POINTS", 81)


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the small run from its beginning to its end."""
    from tests.small_run import small_case, start  # which few tests need

    folder = tmp_path_factory.mktemp("runs") / "unbroken"
    start(small_case(), folder)
    return folder
