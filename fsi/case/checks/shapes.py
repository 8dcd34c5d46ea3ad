"""What bodies that are no discs can be asked for: the resolved level between walls, in the plane."""

from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.errors import InputError


def check_shapes(case: Case) -> None:
    """Raise InputError, which names the first shape, where what is asked for knows discs only."""
    shaped = next(((i, body.shape) for i, body in enumerate(case.bodies) if body.shape is not None), None)
    if shaped is None:
        return
    i, shape = shaped
    here = f"bodies.{i}.shape = {toml_text(shape)}"
    if case.model != "resolved":
        raise InputError(f'{here}: model = "{case.model}" knows discs only; give "resolved", or a radius')
    if len(case.container().periods):
        raise InputError(f"{here}: periodic domains take discs only; give walls, or a radius")
    if case.domain.mesh is not None:
        raise InputError(f"{here}: a mesh of your own is for discs; drop domain.mesh, or give a radius")
    if case.calibration is not None:
        raise InputError(f"{here}: laws are calibrated for discs; drop [calibration], or give a radius")
    if any(force.reach > 0.0 for force in case.forces):
        raise InputError(f"{here}: [[forces]] of the gap act between discs; drop them, or give a radius")
