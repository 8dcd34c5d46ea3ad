"""The set-up's files agree with each other, and bootstrap.sh answers when asked wrongly."""

import re
import subprocess
import tomllib
from collections.abc import Iterable
from itertools import chain
from pathlib import Path

ROOT = Path(__file__).parents[1]
PIN = re.compile(r"^(?P<name>[A-Za-z0-9][\w.-]*)==(?P<version>[\w.]+)", re.MULTILINE)


def pins(file: str) -> dict[str, str]:
    """Names, in the canonical spelling, and their exact versions."""
    found = PIN.finditer((ROOT / file).read_text())
    return {re.sub(r"[-_.]+", "-", pin["name"]).lower(): pin["version"] for pin in found}


def project() -> dict[str, object]:
    with (ROOT / "pyproject.toml").open("rb") as file:
        return tomllib.load(file)


def test_lock_holds_every_direct_dependency_at_its_version() -> None:
    direct, locked = pins("requirements.in"), pins("requirements.lock")
    assert direct
    assert direct.items() <= locked.items()


def test_lock_has_hashes_for_all_and_names_no_host() -> None:
    text = (ROOT / "requirements.lock").read_text()
    blocks = re.split(r"\n(?=[a-z])", text)
    assert len(blocks) > len(pins("requirements.in"))
    assert [b.splitlines()[0] for b in blocks if PIN.match(b) and "--hash=sha256:" not in b] == []
    assert "://" not in text


# What conda-forge calls otherwise, and what it has in place of the solver's wheel.
CONDA_NAMES = {
    "matplotlib-base": "matplotlib",
    "python-gmsh": "gmsh",
    "fenics-dolfinx": "dolfinx-solver-real",
}
CONDA_ALONE = {"python", "mpich", "petsc", "petsc4py", "c-compiler", "pip"}


def bounds(lines: Iterable[str]) -> dict[str, str]:
    """Names, as PyPI has them, and what follows them."""
    split = (re.match(r"([\w.-]+)\s*(.*?)\s*(#.*)?$", line) for line in lines)
    return {CONDA_NAMES.get(found[1], found[1]): found[2] for found in split if found}


def test_both_routes_install_the_same_packages_from_the_same_versions_on() -> None:
    """environment.yml against pyproject.toml, but for the solver, whose wheel is several packages there."""
    table = project()["project"]
    assert isinstance(table, dict)
    extras = table["optional-dependencies"]
    declared = bounds([*table["dependencies"], *chain(*extras.values())])
    listed = (ROOT / "environment.yml").read_text().split("dependencies:\n")[1].splitlines()
    of_conda = bounds(line.removeprefix("  - ") for line in listed if line.startswith("  - "))
    assert set(of_conda) >= CONDA_ALONE
    assert set(declared) == set(of_conda) - CONDA_ALONE
    assert declared.pop("dolfinx-solver-real").startswith("==" + of_conda.pop("dolfinx-solver-real")[1:])
    assert declared == {name: bound for name, bound in of_conda.items() if name not in CONDA_ALONE}
    assert set(declared) <= set(pins("requirements.lock"))


def test_every_declared_dependency_is_pinned() -> None:
    table = project()["project"]
    assert isinstance(table, dict)
    extras = table["optional-dependencies"]
    declared = [*table["dependencies"], *chain(*extras.values())]
    names = {re.split(r"[<>=~!;\[ ]", line)[0].lower() for line in declared}
    assert names == set(pins("requirements.in"))


def test_every_folder_of_modules_is_a_package() -> None:
    """Only packages are installed; the folders at the top are reached through links of `fsi`."""
    folders = {path.parent for top in ("fsi", "meshes", "postprocess") for path in (ROOT / top).rglob("*.py")}
    assert [str(folder) for folder in sorted(folders) if not (folder / "__init__.py").is_file()] == []
    for name in ("meshes", "postprocess", "cases"):
        assert (ROOT / "fsi" / name).resolve() == ROOT / name
    assert (ROOT / "fsi" / "py.typed").is_file()


def test_bootstrap_refuses_an_unknown_command_before_it_installs() -> None:
    done = subprocess.run([ROOT / "bootstrap.sh", "rnu"], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == "error: no such command: rnu; it is run, test or install"


def test_bootstrap_is_valid_shell() -> None:
    subprocess.run(["bash", "-n", ROOT / "bootstrap.sh"], check=True)
