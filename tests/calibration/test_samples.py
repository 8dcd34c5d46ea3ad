"""The files that keep samples: damaged ones are refused in one line, which says what to do."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from fsi.calibration.samples import Sample, keep_sample, read_sample
from fsi.errors import InputError

SAMPLE = Sample(0.1, True, 5.0, 1e-3, 2e-4, 100, 1e-12, 0.1)


@pytest.mark.parametrize(
    ("change", "wrong"),
    [
        ({"kappa": float("nan")}, "it has kappa = nan"),
        ({"kappa": -5.0}, r"it has kappa = -5\.0"),
        ({"kappa": 0.0}, r"it has kappa = 0\.0"),
        ({"kappa": True}, "it has kappa = true"),
        ({"kappa": "5"}, 'it has kappa = "5"'),
        ({"mesh_error": float("inf")}, "it has mesh_error = inf"),
        ({"mesh_error": -1.0}, r"it has mesh_error = -1\.0"),
        ({"truncation": None}, "it has truncation = None"),
        ({"held_out": 1}, "it has held_out = 1"),
        ({"gap": 0.2}, r"it has gap = 0\.2 in place of 0\.1"),
        ({"dofs": 10**30}, "it is no sample"),
        ({"colour": 1.0}, "it is no sample"),
    ],
)
def test_a_sample_of_no_sense_is_refused(change: dict[str, object], wrong: str, tmp_path: Path) -> None:
    """NaN, infinite and negative numbers, of which a law and its errors would be made, and another gap."""
    (tmp_path / "key.json").write_text(json.dumps(asdict(SAMPLE) | change))
    refusal = rf"^.*key\.json: is damaged, {wrong}; remove it, and it is computed again$"
    with pytest.raises(InputError, match=refusal):
        read_sample(tmp_path, "key", 0.1, held_out=True)


@pytest.mark.parametrize("part", [0, 20, -1])
def test_a_part_of_a_file_is_refused(part: int, tmp_path: Path) -> None:
    keep_sample(tmp_path, "key", SAMPLE)
    (tmp_path / "key.json").write_bytes((tmp_path / "key.json").read_bytes()[:part])
    with pytest.raises(InputError, match=r"is damaged, it is no sample; remove it, and it is computed"):
        read_sample(tmp_path, "key", 0.1, held_out=True)


def test_what_is_kept_comes_back(tmp_path: Path) -> None:
    """The gap of a body at the same place may be rounded in another way."""
    assert read_sample(tmp_path, "key", 0.1, held_out=True) is None
    keep_sample(tmp_path, "key", SAMPLE)
    assert read_sample(tmp_path, "key", 0.1 * (1.0 + 1e-12), held_out=True) == SAMPLE
