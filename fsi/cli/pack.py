"""`fsi pack`: arrange discs, ellipses, rods or spheres in a cell."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import fsi.parallel as parallel
from fsi.arrangements.names import CellKind, Kind, Outline, Sizes
from fsi.cli.arguments import option, output_to, require_writable, warn
from fsi.errors import InputError
from fsi.machine.resources import require_memory

if TYPE_CHECKING:
    from fsi.arrangements.arrangement import Arrangement, Wanted
    from fsi.arrangements.cell import SimulationCell

EXAMPLE = "Example: fsi pack random --number 50 --area-fraction 0.4 --gap 0.02 --seed 1 -o random.json"

_BODY_SECONDS = 1.4e-3  # measured at 20 000 bodies at random
_MANY = 100_000  # from which on it is said how long it takes


def pack(
    kind: Annotated[Kind, typer.Argument(help="How the bodies are arranged.", show_default=False)],
    output: Annotated[Path, output_to("The file of bodies: .json")],
    number: Annotated[int, option("How many bodies.", True, "--number", "-n", min=1)] = 50,
    area_fraction: Annotated[
        float, option("The part of the cell that the bodies fill (in space, of the volume).")
    ] = 0.4,
    radius: Annotated[float, option("The mean radius.")] = 1.0,
    gap: Annotated[
        float | None, option("The smallest gap, between bodies and to walls.", "0.02 radii")
    ] = None,
    cell: Annotated[
        CellKind, option("Walls above and below only, none at all, or all round; periodic sides elsewhere.")
    ] = "channel",
    seed: Annotated[int | None, option("Of random.", "1", min=0)] = None,
    aspect: Annotated[float | None, option("Of random: length over height of the cell.", "1")] = None,
    sizes: Annotated[Sizes | None, option("Of random: the radii.", "equal")] = None,
    spread: Annotated[
        float | None,
        option(
            "Of random: large over small radius (bidisperse), deviation over mean radius (lognormal).",
            "1.4, 0.2",
        ),
    ] = None,
    dimension: Annotated[
        int | None, option("Of random: 2 for discs, 3 for spheres.", "2", min=2, max=3)
    ] = None,
    shape: Annotated[
        Outline | None, option("Of random: ellipses and rods have the area of a disc of the radius.", "disc")
    ] = None,
    ratio: Annotated[float | None, option("Of ellipses and rods: length over width.", "2")] = None,
    aligned: Annotated[
        float | None, option("Of ellipses and rods: the angle of all, in degrees to x.", "all directions")
    ] = None,
    rows: Annotated[
        int | None, option("Of arrays and rows; layers of chains.", "square cell; 1 layer", min=1)
    ] = None,
    length: Annotated[
        int | None, option("Discs in each chain or column.", "4; square root of the number", min=1)
    ] = None,
    angle: Annotated[float | None, option("Of chains and columns: degrees from the flow.", "135; 90")] = None,
    picture: Annotated[Path | None, option("The picture.", "beside the file, .png")] = None,
) -> None:
    """Arrange bodies at an area fraction: at random, in arrays, rows, chains, columns, or crystals.

    The file is one that a case takes by `bodies_from`; it is drawn as well. The cell begins at the origin,
    and the area fraction determines its size. Random is the fluid of hard bodies;
    where it is dense, above 0.45, up to a fifth more pairs are near contact than in equilibrium.
    """
    from fsi.arrangements.request import wanted

    drawn = picture or output.with_suffix(".png")
    _require_sense(output, drawn, kind, number)
    smallest = 0.02 * radius if gap is None else gap
    common = {"number": number, "fraction": area_fraction, "radius": radius, "gap": smallest, "cell": cell}
    options = {"seed": seed, "aspect": aspect, "sizes": sizes, "spread": spread, "dimension": dimension,
               "shape": shape, "ratio": ratio, "aligned": aligned,
               "rows": rows, "length": length, "angle": angle}  # fmt: skip
    given = {key: value for key, value in options.items() if value is not None}
    asked = wanted(kind, common, given, _spelled)
    parallel.on_root(lambda: _make(kind, asked, output, drawn))


def _require_sense(output: Path, drawn: Path, kind: Kind, number: int) -> None:
    """Raise InputError: the files cannot be written, or memory is too small; say if it takes minutes."""
    from fsi.arrangements.arrangement import BODY_BYTES

    if output.suffix != ".json":
        raise InputError(f"output = {output}: ends in {output.suffix or 'nothing'}; give a .json file")
    for path in (output, drawn):
        require_writable(path)
    require_memory(f"--number {number}", BODY_BYTES * number, "give fewer")
    if kind == "random" and number > _MANY:
        warn(f"{number} bodies at random: some {_BODY_SECONDS * number / 60.0:.0f} minutes")


def _spelled(name: str, value: Any) -> str:
    return f"--{name.replace('_', '-')} {value}"


def _make(kind: Kind, wanted: Wanted, output: Path, drawn: Path) -> None:
    from fsi.arrangements.kinds import KINDS, arrange, write_arrangement
    from fsi.postprocess.plots.arrangement import draw_arrangement

    arrangement = arrange(kind, wanted)
    unused = ("shape", "ratio", "aligned") if arrangement.shape is None else ()
    described = {
        "kind": kind,
        "area_fraction": arrangement.fraction(),
        "gap": wanted.gap,
        **{name: getattr(wanted, name) for name in KINDS[kind].options if name not in unused},
    }
    write_arrangement(arrangement, output, described)
    draw_arrangement(arrangement, drawn)
    _tell(arrangement, output, drawn)


def _tell(arrangement: Arrangement, output: Path, drawn: Path) -> None:
    """What was made, and the [domain] that it fits in."""
    gaps = f"smallest gap {arrangement.smallest_gap():.4g}"
    if arrangement.cell.walled.size:
        gaps += f", to a wall {arrangement.smallest_wall_gap():.4g}"
    filled = f"{arrangement.fraction_name} {arrangement.fraction():.6g}"
    typer.echo(f"{len(arrangement.radii)} bodies, {filled}, {gaps}")
    typer.echo("\n".join(_domain(arrangement.cell)))
    typer.echo(f"wrote {output} and {drawn}")


def _domain(cell: SimulationCell) -> list[str]:
    """The lines of a case that make this cell its domain."""
    if all(cell.periodic):
        sides = enumerate(cell.sides)
        vectors = [[side if k == axis else 0.0 for k in range(cell.dimension)] for axis, side in sides]
        return ['domain.shape = "cell"', f"domain.vectors = {vectors}"]
    upper = ", ".join(repr(side) for side in cell.sides)
    lower = ", ".join("0.0" for _ in cell.sides)
    periodic = ", ".join(f'"{axis}"' for axis, so in zip("xyz", cell.periodic, strict=False) if so)
    lines = [f"domain.lower = [{lower}]", f"domain.upper = [{upper}]"]
    return [*lines, f"domain.periodic = [{periodic}]"] if periodic else lines
