"""Which model a case asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fsi.stepping import Model

if TYPE_CHECKING:
    from fsi.case import Case


def make_model(case: Case) -> Model:
    """The model that gives the velocities of the bodies of a case."""
    from fsi.stokes.model import StokesModel  # dolfinx is imported where it is needed, and only there

    return StokesModel(case)
