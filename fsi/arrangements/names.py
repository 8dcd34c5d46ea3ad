"""The words by which arrangements are asked for; plain, as `fsi pack --help` names none of a `type`."""

from typing import Literal

Kind = Literal[
    "random", "square", "hexagonal", "rows", "chains", "columns",
    "simple-cubic", "body-centred", "face-centred", "close-packed",
]  # fmt: skip
CellKind = Literal["channel", "periodic", "box"]
Outline = Literal["disc", "ellipse", "rod"]
Sizes = Literal["equal", "bidisperse", "lognormal"]
