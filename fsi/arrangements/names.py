"""The words by which arrangements are asked for."""

from typing import Literal

type Kind = Literal[
    "random", "square", "hexagonal", "rows", "chains", "columns",
    "simple-cubic", "body-centred", "face-centred", "close-packed",
]  # fmt: skip
type CellKind = Literal["channel", "periodic", "box"]
type Outline = Literal["disc", "ellipse", "rod"]
type Sizes = Literal["equal", "bidisperse", "lognormal"]
