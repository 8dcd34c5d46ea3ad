"""The one line that each mistake in a periodic domain gives."""

from __future__ import annotations

from typing import Any

import pytest

from fsi.case.domains.box import ChannelDomain
from fsi.case.load import parse_case
from fsi.case.section import CaseContext
from fsi.errors import InputError
from tests.case_data import changed

CHANNEL = {"lower": [-8.0, 0.0], "upper": [8.0, 16.0], "periodic": ["x"]}
CELL = {"shape": "cell", "vectors": [[8.0, 0.0], [1.0, 8.0]]}


@pytest.mark.parametrize(
    ("domain", "parts"),
    [
        (CHANNEL | {"periodic": ["z"]}, ["domain.periodic", '"x"']),
        (CHANNEL | {"walls": {"left": [0.0, 1.0]}}, ["domain.walls", "no wall left", "drop walls.left"]),
        (CHANNEL | {"walls": {"botom": [0.0, 1.0]}}, ["domain.walls", "bottom"]),
        (CHANNEL | {"upper": [-9.0, 16.0]}, ["domain.upper", "right of and above"]),
        (CHANNEL | {"net_flux": 1.0, "pressure_gradient": 2.0}, ["domain.net_flux", "drop one"]),
        (CHANNEL | {"mesh": "own.msh"}, ["domain.mesh", "drop it"]),
        (CHANNEL | {"presure_gradient": 1.0}, ["domain.presure_gradient", "use domain.pressure_gradient"]),
        (CHANNEL | {"upper": [-4.5, 16.0]}, ["bodies.", "overlap", "move them apart"]),
        (CELL | {"vectors": [[8.0, 0.0], [16.0, 0.0]]}, ["domain.vectors", "parallel"]),
        (CELL | {"vectors": [[8.0, 0.0]]}, ["domain.vectors"]),
        (
            CELL | {"vectors": [[1.9, 0.0], [0.0, 8.0]]},
            ["bodies.0.position", "its image", "overlap"],
        ),
        (CELL | {"vectors": [[1e-7, 0.0], [0.0, 8.0]]}, ["bodies.0.position", "its image overlap"]),
        (CELL | {"shear": 1.0, "extension": 1.0}, ["domain.extension", "drop one"]),
        (CELL | {"walls": {"top": [1.0, 0.0]}}, ["domain.walls", "no walls", "drop it"]),
        (CELL | {"vectors": [[1e-300, 0.0], [0.0, 8.0]]}, ["domain.vectors", "far too short"]),
        (CELL | {"vectors": [[8e12, 0.0], [0.0, 8.0]]}, ["domain.vectors", "far too short"]),
        (CELL | {"geometry": "planar"}, ["domain.geometry", "unknown key", "use domain.shape, domain.walls"]),
        (CHANNEL | {"periodic": ["x", "y"]}, ["domain.periodic", 'for all directions give shape = "cell"']),
        (CELL | {"uniaxial": 1.0}, ["domain.uniaxial", "is for space; give extension"]),
        (CELL | {"vectors": [[8.0, 0.0, 0.0], [1.0, 8.0, 0.0]]}, ["domain.vectors", "a lattice vector"]),
        ({"vectors": CELL["vectors"]}, ["domain.shape", "missing", '"cell"']),
    ],
)
def test_mistakes(domain: dict[str, Any], parts: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        parse_case(changed("domain", domain))
    assert "\n" not in str(caught.value)
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize("domain", [CHANNEL, CELL])
def test_only_planar_domains_are_periodic(domain: dict[str, Any]) -> None:
    body = {"name": "ball", "radius": 1.0, "position": [0.0, 3.0]}
    data = changed("bodies", [body]) | {"domain": domain, "geometry": "axisymmetric"}
    with pytest.raises(InputError, match="planar"):
        parse_case(data)


@pytest.mark.parametrize("domain", [CHANNEL, CELL])
def test_an_image_too_far_away_to_be_told(domain: dict[str, Any]) -> None:
    """1e30 is rounded to whole multiples of 1e14 periods: where the body lies in the cell is not known."""
    body = {"name": "disc", "radius": 1.0, "position": [1e30, 3.0]}
    with pytest.raises(InputError, match=r"bodies\.0\.position = \[1e\+30, 3\.0\]: .* near the origin"):
        parse_case(changed("bodies", [body]) | {"domain": domain})


@pytest.mark.parametrize("domain", [CHANNEL, CELL])
def test_a_force_that_reaches_beyond_the_images_that_are_looked_for(domain: dict[str, Any]) -> None:
    """It would be cut off unsaid: 22.6 in the channel, and sqrt(2 64) in the cell at any strain."""
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 3.0]}
    law = {"kind": "repulsion", "law": "power", "strength": 1.0, "length": 0.1, "exponent": 1.0}
    data = changed("bodies", [body]) | {"domain": domain}
    with pytest.raises(
        InputError, match=r"forces\.0\.cutoff = 30\.0: reaches farther .* gap of (22\.6|11\.3)"
    ):
        parse_case(data | {"forces": [law | {"cutoff": 30.0}]})
    parse_case(data | {"forces": [law | {"cutoff": 11.0}]})
    table = {"kind": "repulsion", "law": "table", "gaps": [0.1, 30.0], "values": [1.0, 0.0]}
    with pytest.raises(InputError, match=r"forces\.0\.gaps = \[0\.1, 30\.0\]: reaches farther"):
        parse_case(data | {"forces": [table]})


def test_bodies_of_a_cell_have_no_inertia() -> None:
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 3.0], "mass": 1.0, "moment_of_inertia": 1.0}
    with pytest.raises(
        InputError, match=r"0\.mass = 1\.0: .*no inertia; drop it and bodies\.0\.moment_of_inertia$"
    ):
        parse_case(changed("bodies", [body]) | {"domain": CELL})


def test_the_iterative_solver_is_not_for_periodic_domains() -> None:
    data = changed("domain", CHANNEL) | {"discretisation": {"solver": "iterative"}}
    with pytest.raises(InputError, match=r'discretisation\.solver = "iterative"'):
        parse_case(data)


@pytest.mark.parametrize("geometry", ["planar", "spatial"])
def test_a_box_may_be_periodic_in_any_directions_without_fluid(geometry: Any) -> None:
    """The section makes the container; only what solves for a flow refuses it."""
    lower, upper = (0.0, 0.0, 0.0), (2.0, 3.0, 4.0)
    d = 2 if geometry == "planar" else 3
    for periodic in (("y",), ("x", "y"), ("x", "y", "z")[:d]):
        data = {"lower": lower[:d], "upper": upper[:d], "periodic": periodic}
        domain = ChannelDomain.model_validate(data, context=CaseContext(geometry))
        container = domain.container()
        assert tuple(domain.walls) == container.walls
        assert len(container.periods) == len(periodic)
        if periodic == ("x", "y") and d == 3:
            domain.require_fluid()
            continue
        with pytest.raises(InputError, match=r"domain\.periodic = .*only in boxes between two walls"):
            domain.require_fluid()


def in_space(domain: dict[str, Any]) -> dict[str, Any]:
    return {
        "name": "test", "geometry": "spatial", "fluid": {"viscosity": 1.0}, "domain": domain,
        "bodies": [{"name": "ball", "radius": 1.0, "position": [4.0, 4.0, 4.0]}],
    }  # fmt: skip


CUBE = {"shape": "cell", "vectors": [[8.0, 0.0, 0.0], [1.0, 8.0, 0.0], [0.0, 2.0, 8.0]]}


@pytest.mark.parametrize(
    ("domain", "parts"),
    [
        (CUBE | {"vectors": [*CUBE["vectors"][:2], [9.0, 8.0, 0.0]]}, ["domain.vectors", "coplanar"]),
        (CUBE | {"vectors": CUBE["vectors"][:2]}, ["domain.vectors", "2 vectors", "give three"]),
        (CUBE | {"shear": 1.0, "uniaxial": 1.0}, ["domain.uniaxial", "shear is given too", "drop one"]),
        (CUBE | {"extension": 1.0, "uniaxial": 1.0}, ["domain.uniaxial", "extension is given too"]),
        (CUBE | {"vectors": [[1.9, 0.0, 0.0], *CUBE["vectors"][1:]]}, ["bodies.0.position", "its image"]),
        ({"lower": [0.0] * 3, "upper": [8.0] * 3, "periodic": ["x"]}, ["domain.periodic", '["x", "y"]']),
    ],
)
def test_mistakes_in_space(domain: dict[str, Any], parts: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        parse_case(in_space(domain))
    assert "\n" not in str(caught.value)
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize(
    ("flow", "E"),
    [
        ({"shear": 2.0}, [[0.0, 0.0, 2.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]),
        ({"extension": 2.0}, [[2.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, -2.0]]),
        ({"uniaxial": 2.0}, [[2.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]),
    ],
)
def test_mean_flows_in_space(flow: dict[str, float], E: list[list[float]]) -> None:
    assert parse_case(in_space(CUBE | flow)).container().mean_gradient.tolist() == E


@pytest.mark.parametrize("periodic", [["z"], ["x", "x"], []])
def test_each_direction_is_named_once(periodic: list[str]) -> None:
    with pytest.raises(InputError, match=r"domain\.periodic = .* each of some directions of x, y once"):
        parse_case(changed("domain", CHANNEL | {"periodic": periodic}))


@pytest.mark.parametrize(("width", "refused"), [(8.1, False), (7.9, True)])
def test_a_gluey_period_is_at_least_four_diameters_wide(width: float, refused: bool) -> None:
    """A body of radius 1 between its images: below, pairs of images could meet at once."""
    data = {
        "name": "test", "model": "gluey", "bodies": [{"name": "a", "radius": 1.0, "position": [1.0, 0.0]}],
        "domain": {"lower": [0.0, -9.0], "upper": [width, 9.0], "periodic": ["x"]},
        "time": {"end": 1.0, "step": 0.1},
    }  # fmt: skip
    if refused:
        with pytest.raises(InputError, match=r"a period of .* is below four diameters"):
            parse_case(data)
    else:
        parse_case(data)


@pytest.mark.parametrize(("mass", "refused"), [(2.0, False), (2.002, True), (4.0, True)])
def test_matter_on_a_line_has_one_density(mass: float, refused: bool) -> None:
    """Radii 1 and 2, so masses 1 and 2; a thousandth more is another density."""
    bodies = [
        {"name": f"b{k}", "radius": a, "position": [5.0 * k, 0.0], "mass": m, "moment_of_inertia": 1.0}
        for k, (a, m) in enumerate([(1.0, 1.0), (2.0, mass)])
    ]
    data = {
        "name": "test", "model": "macroscopic", "bodies": bodies, "macroscopic": {"parcels": 30},
        "domain": {"lower": [-50.0, -50.0], "upper": [50.0, 50.0]}, "time": {"end": 1.0, "step": 0.1},
    }  # fmt: skip
    if refused:
        with pytest.raises(InputError, match=r"bodies.1.mass = .*: matter has one density.*; give 2$"):
            parse_case(data)
    else:
        parse_case(data)


def test_slip_in_periodic_space_is_for_no_model() -> None:
    """The reduced model led to the resolved one, which refuses it too."""
    ball = {"name": "ball", "radius": 1.0, "position": [0.0, 0.0, 3.0], "slip_length": 0.1}
    cell = {"shape": "cell", "vectors": [[8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]]}
    for model in ("reduced", "resolved"):
        data = {"name": "slip", "model": model, "geometry": "spatial", "domain": cell, "bodies": [ball]}
        with pytest.raises(InputError, match=r"slip_length = 0\.1: fluid sticks .* in space; drop it$"):
            parse_case(data | {"fluid": {"viscosity": 1.0}})
