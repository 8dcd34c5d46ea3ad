"""The shapes of domains; importing them registers them, in the order in which messages name them."""

# isort: off
from fsi.case.domains import box, radial, cell, unbounded
from fsi.case.domain import Domain
# isort: on

__all__ = ["Domain", "box", "cell", "radial", "unbounded"]
