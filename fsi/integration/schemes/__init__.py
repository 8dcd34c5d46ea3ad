"""Time schemes, one file each; `time.scheme` chooses one by its name, in `registry.SCHEMES`."""

from fsi.integration.schemes.ascher_ruuth_spiteri import AscherRuuthSpiteri
from fsi.integration.schemes.bogacki_shampine import BogackiShampine
from fsi.integration.schemes.distance import DistanceScheme
from fsi.integration.schemes.registry import SCHEMES, Beginning, register_scheme, scheme_for

__all__ = [
    "SCHEMES",
    "AscherRuuthSpiteri",
    "Beginning",
    "BogackiShampine",
    "DistanceScheme",
    "register_scheme",
    "scheme_for",
]
