"""What memory there is: the machine's, or less where a limit of the process or of its groups says so."""

from __future__ import annotations

import resource
from pathlib import Path

import pytest

import fsi.machine.resources as resources

UNLIMITED = (resource.RLIM_INFINITY, resource.RLIM_INFINITY)


@pytest.fixture
def groups(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A machine with no limits: its list of groups, beside the folders of both versions, `2` and `1`."""
    limits = {"": (tmp_path / "2", "memory.max"), "memory": (tmp_path / "1", "memory.limit_in_bytes")}
    monkeypatch.setattr(resources, "_LIMITS", limits)
    monkeypatch.setattr(resources, "_GROUPS", tmp_path / "groups")
    monkeypatch.setattr(resource, "getrlimit", lambda _: UNLIMITED)
    return tmp_path / "groups"


def limit(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text + "\n")


def test_the_address_space_of_the_process_is_a_limit(groups: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`ulimit -v` refuses what the machine has."""
    whole = resources.memory()
    monkeypatch.setattr(resource, "getrlimit", lambda _: (3 * 10**7, resource.RLIM_INFINITY))
    assert not groups.exists()
    assert resources.memory() == 3e7 < whole


@pytest.mark.parametrize(
    ("job", "user"), [("20000000", "max"), ("max", "20000000"), ("30000000", "20000000")]
)
def test_the_least_of_groups_in_each_other(job: str, user: str, groups: Path) -> None:
    """A batch job has its limit in its own group, which the outermost knows nothing of."""
    groups.write_text("0::/user.slice/job_7\n")
    limit(groups.parent / "2/user.slice/job_7/memory.max", job)
    limit(groups.parent / "2/user.slice/memory.max", user)
    assert resources.memory() == 2e7


def test_groups_of_version_1(groups: Path) -> None:
    groups.write_text("11:cpu,cpuacct:/\n9:memory:/slurm/job_7\n1:name=systemd:/\n")
    limit(groups.parent / "1/slurm/job_7/memory.limit_in_bytes", "20000000")
    limit(groups.parent / "1/memory.limit_in_bytes", "9223372036854771712")  # says none
    assert resources.memory() == 2e7


def test_a_container_has_its_own_as_the_outermost(groups: Path) -> None:
    groups.write_text("0::/docker/that/is/not/seen\n")
    limit(groups.parent / "2/memory.max", "20000000")
    assert resources.memory() == 2e7
