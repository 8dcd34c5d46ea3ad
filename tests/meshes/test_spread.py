"""Nodes along many curves at once are those along each by itself."""

import numpy as np
import pytest

from fsi.arrays import Indices
from fsi.meshes.errors import MeshError
from fsi.meshes.planar import spread as module
from fsi.meshes.planar.spread import equidistribute, equidistribute_all, resolve_all, spread, spread_all


def sampled(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places, sizes and numbers of five curves, the lengths of which differ by seven powers of ten."""
    random = np.random.default_rng(seed)
    each = [np.cumsum(random.uniform(0.5, 1.5, n)) * 10.0**k for k, n in enumerate((2, 9, 40, 3, 17), -4)]
    s = np.concatenate(each)
    return s, s * random.uniform(0.02, 0.5, len(s)), np.repeat(np.arange(5), [len(x) for x in each])


@pytest.mark.parametrize("seed", range(5))
def test_parts_of_each_curve_are_equal(seed: int) -> None:
    """By NumPy's own interpolation of the sum along each curve."""
    s, h, k = sampled(seed)
    least = np.array([1, 4, 1, 30, 2])
    at, of = equidistribute_all(s, 1.0 / h, k, least)
    for j in range(5):
        x, density = s[k == j], 1.0 / h[k == j]
        total = np.append(0.0, np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(x)))
        parts = max(int(least[j]), int(np.ceil(total[-1] - 1e-6)))
        expected = np.interp(np.linspace(0.0, total[-1], parts + 1), total, x)
        np.testing.assert_allclose(at[of == j], expected, rtol=1e-14, atol=0.0)
        assert (at[of == j][0], at[of == j][-1]) == (x[0], x[-1])
        np.testing.assert_array_equal(equidistribute(x, density, int(least[j])), at[of == j])


def test_curves_with_fixed_places_are_spread_among_others() -> None:
    s, h, k = sampled(7)
    inner = s[k == 2][10] + 1e-3 * np.arange(4.0)
    fixed = [[], [], [inner], [], [s[k == 4][:3]]]
    fewest = np.array([0.2, 3.5, 8.0, 5.0, 8.0])
    placed = spread_all(s, h, k, fixed, fewest)
    assert len(placed) == 5
    for j, places in enumerate(placed):
        alone = spread(s[k == j], h[k == j], fixed[j], float(fewest[j]))
        np.testing.assert_allclose(places, alone, rtol=1e-14, atol=0.0)
    assert np.isin(inner, placed[2]).all()


def beside_places(s: np.ndarray, k: Indices) -> np.ndarray:
    """Sizes that grow from 1e-5 where each of three curves is nearest to something."""
    size: np.ndarray = 1e-5 + 0.3 * np.abs(s - np.array([0.3, -2.0, 1.7])[k])
    return size


def test_sizes_that_are_found_ahead_change_no_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of few intervals several halvings are looked at in one call: places and their order are the same."""
    ends = np.array([[0.0, 1.0], [-3.0, 4.0], [1.7, 40.0]])
    calls = list[int]()

    def counted(s: np.ndarray, k: Indices) -> np.ndarray:
        calls.append(len(s))
        return beside_places(s, k)

    found = resolve_all(counted, ends, 4)
    ahead = len(calls)
    monkeypatch.setattr(module, "FEW", 0)
    one_by_one = resolve_all(counted, ends, 4)
    for values, expected in zip(found, one_by_one, strict=True):
        np.testing.assert_array_equal(values, expected)
    assert 2 * ahead < len(calls) - ahead
    s, h, k = found
    inside = k[:-1] == k[1:]
    assert np.all((np.diff(s) <= 0.5 * np.minimum(h[:-1], h[1:]))[inside])
    np.testing.assert_array_equal(h, beside_places(s, k))


def test_sizes_that_vanish_are_an_error() -> None:
    with pytest.raises(MeshError, match="cannot be resolved"):
        resolve_all(lambda s, _: np.abs(s - 0.3), np.array([[0.0, 1.0]]), 3)
