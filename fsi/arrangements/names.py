"""The words by which arrangements are asked for."""

from typing import Literal

type Kind = Literal["random", "square", "hexagonal", "rows", "chains", "columns"]
type CellKind = Literal["channel", "periodic", "box"]
type Sizes = Literal["equal", "bidisperse", "lognormal"]
