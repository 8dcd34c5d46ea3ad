"""Shapes and wall profiles of one's own whose curve or derivatives are wrong: refused as they enter."""

from __future__ import annotations

from typing import Any, Literal, override

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.case.profiles.profile import WallProfile, register_profile
from fsi.case.shapes.shape import BodyShape, register_shape
from fsi.errors import InputError
from fsi.meshes.geometry.jets import Jet, JetOf
from fsi.meshes.geometry.relief import Heights


class Wrong(BodyShape):
    """The unit circle, but for what is wrong with it."""

    kind: Literal["wrong-of-tests"]
    how: str
    """a word"""

    @override
    def curve(self) -> JetOf:
        def jet(t: Array) -> Jet:
            w = np.pi if self.how == "half" else 2.0 * np.pi
            x = np.column_stack([np.cos(w * t), np.sin(w * t)])
            dx, ddx = w * np.column_stack([-x[:, 1], x[:, 0]]), -(w**2) * x
            match self.how:
                case "spiral":
                    return Jet(x * (1.0 + 0.3 * t[:, None]), dx, ddx)
                case "swapped":
                    return Jet(x, dx[:, ::-1], ddx)
                case "dx":
                    return Jet(x, 0.5 * dx, ddx)
                case "zero":
                    return Jet(x, 0.0 * dx, ddx)
                case "ddx":
                    return Jet(x, dx, 2.0 * ddx)
                case "nan":
                    return Jet(np.where(t[:, None] > 0.55, np.nan, x), dx, ddx)
                case "tiny":
                    return Jet(1e-70 * x, 1e-70 * dx, 1e-70 * ddx)
                case "misspelt":
                    return Jet(x, dx, ddx * self.hwo)  # type: ignore[attr-defined]
            return Jet(x, dx, ddx)

        return jet


class WrongWall(WallProfile):
    """A hump (1 + cos(pi s)) / 8 for -1 <= s <= 1, but for what is wrong with it."""

    kind: Literal["wrong-of-tests"]
    how: str
    """a word"""

    @override
    def heights(self) -> Heights:
        step = 0.1 * (self.how == "step")
        slope, dh, ddh = (
            0.1 * (self.how == "slope"),
            0.5 if self.how == "dh" else 1.0,
            -1.0 if self.how == "ddh" else 1.0,
        )

        def at(s: Array) -> tuple[Array, Array, Array]:
            c, k = np.cos(np.pi * s), np.pi
            if self.how == "scalar":
                return 0.0  # type: ignore[return-value]
            h, along = 0.125 * (1.0 + c) + step, -0.125 * k * np.sin(np.pi * s)
            return h + slope * (s + 1.0), dh * along + slope, -ddh * 0.125 * k**2 * c

        return Heights((1.0, -1.0) if self.how == "backwards" else (-1.0, 1.0), (), at)


class Edged(WallProfile):
    """h = (g(s - 1/2) + g(s + 1/2)) / 2 - g(s), g = sqrt(s^2 + bend^2): a roof with three sharp bends."""

    kind: Literal["edged-of-tests"]
    bend: float
    """the radius of its bends, a number > 0"""
    sign: float = 1.0
    """times its second derivative"""

    @override
    def heights(self) -> Heights:
        def g(s: Array) -> Array:
            root = np.hypot(s, self.bend)
            return np.array([root, s / root, self.bend**2 / root**3])

        def at(s: Array) -> tuple[Array, Array, Array]:
            h, dh, ddh = 0.5 * (g(s - 0.5) + g(s + 0.5)) - g(s)
            return h, dh, self.sign * ddh

        return Heights((-2.0, 2.0), (), at)


@pytest.fixture(autouse=True)
def registered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Registered for one test only: messages list all of them."""
    for registry in (BodyShape.registry, WallProfile.registry):
        monkeypatch.setattr(registry, "sections", [*registry.all()])
    register_shape(Wrong)
    register_profile(WrongWall)
    register_profile(Edged)


def case(shape: dict[str, Any] | None = None, profile: dict[str, Any] | None = None) -> Case:
    body = {"radius": 1.0} if shape is None else {"shape": shape}
    domain = {"lower": [-4.0, 0.0], "upper": [4.0, 4.0]}
    return parse_case(
        {
            "name": "own curves",
            "fluid": {"viscosity": 1.0},
            "domain": domain if profile is None else domain | {"profiles": {"bottom": profile}},
            "bodies": [{"name": "body", "position": [0.0, 2.0]} | body],
        }
    )


@pytest.mark.parametrize(
    ("how", "fault"),
    [
        ("half", "does not close"),
        ("spiral", "does not close"),
        ("swapped", "has derivatives that are not those of its points"),
        ("dx", "has derivatives that are not those of its points"),
        ("zero", "has derivatives that are not those of its points"),
        ("ddx", "has derivatives that are not those of its points"),
        ("nan", r"has points that are NaN, the first at t = 0\.6; correct its curve$"),
        ("tiny", "is too small or too large for numbers; give lengths in another unit$"),
        ("misspelt", "test_own_curves.Wrong: AttributeError: 'Wrong' object .* 'hwo'; mend that class$"),
    ],
)
def test_a_wrong_curve_is_refused(how: str, fault: str) -> None:
    """With the columns of dx swapped the force of a unit disc was a tenth off, and no error bar said so."""
    case({"kind": "wrong-of-tests", "how": "nothing"})
    with pytest.raises(InputError, match=rf"bodies\.0\.shape = .*{fault}"):
        case({"kind": "wrong-of-tests", "how": how})


@pytest.mark.parametrize(
    ("how", "fault"),
    [
        ("backwards", "ends before it begins"),
        ("step", "a step or a slope"),
        ("slope", "a step or a slope"),
        ("dh", "has derivatives that are not those of its heights"),
        ("ddh", "has derivatives that are not those of its heights"),
        ("scalar", "test_own_curves.WrongWall: TypeError: 'float' object is not iterable; mend that class$"),
    ],
)
def test_wrong_heights_are_refused(how: str, fault: str) -> None:
    """Meshes failed of a step or slope; with h'' of the wrong sign a solve took minutes."""
    case(profile={"kind": "wrong-of-tests", "how": "nothing"})
    with pytest.raises(InputError, match=rf"domain\.profiles\.bottom = .*{fault}"):
        case(profile={"kind": "wrong-of-tests", "how": how})


def test_sharp_bends_are_no_fault() -> None:
    """Between evenly spaced places, 4e-3 apart, differences tell nothing of derivatives in them."""
    case(profile={"kind": "edged-of-tests", "bend": 1e-4})
    with pytest.raises(InputError, match="derivatives that are not those of its heights"):
        case(profile={"kind": "edged-of-tests", "bend": 1e-4, "sign": -1.0})
