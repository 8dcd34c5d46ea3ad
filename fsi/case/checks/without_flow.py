"""What a case must satisfy at the levels that solve for no flow."""

from fsi.case.case import Case
from fsi.case.section import refusal
from fsi.errors import InputError

# Of the smallest radius: an overlap that is rounding in a contact.
ROUNDING = 1e-10


def check_estimates(case: Case) -> None:
    """There is no mesh."""
    if case.output.error_estimates:
        raise InputError(
            f'output.error_estimates = true: model = "{case.model}" has no mesh to estimate the error of; '
            "drop it"
        )


def check_rest(case: Case) -> None:
    """Walls are at rest, and nothing drives a mean flow."""
    for name, wall in case.domain.walls.items():
        if not wall.rests:
            raise refusal(
                f"domain.walls.{name}",
                wall,
                f"walls of the {case.model} model are solid and at rest; drop it",
            )
    case.domain.require_undriven(f"no fluid drives {case.model} bodies")
