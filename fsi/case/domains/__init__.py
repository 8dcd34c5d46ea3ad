"""The shapes of domains, one file for each; importing them registers them, in the order of messages."""

# isort: off
from fsi.case.domains import box
from fsi.case.domains import half_plane
from fsi.case.domains import round_container
from fsi.case.domains import cell
from fsi.case.domains import unbounded
from fsi.case.domain import Domain
# isort: on

__all__ = ["Domain", "box", "cell", "half_plane", "round_container", "unbounded"]
