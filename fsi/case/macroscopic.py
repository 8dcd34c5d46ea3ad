"""The section [macroscopic] of a case file: blocks of matter on a line, the force on it, its parcels.

Some are functions of position, mass and time, given as formulas like "where(t > 1, 2*m, 0)".
"""

import ast
import itertools
from types import CodeType
from typing import Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from fsi.arrays import Array
from fsi.case.section import Section

FUNCTIONS = {
    "sin": np.sin, "cos": np.cos, "exp": np.exp, "sqrt": np.sqrt, "abs": np.abs, "sign": np.sign,
    "tanh": np.tanh, "minimum": np.minimum, "maximum": np.maximum, "where": np.where,
}  # fmt: skip
_ARGUMENTS = {"minimum": 2, "maximum": 2, "where": 3}  # of others one: NumPy would write into a further one
_NODES = (
    ast.Expression, ast.BinOp, ast.UnaryOp, ast.Compare, ast.Call, ast.Name, ast.Load, ast.Constant,
    ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow, ast.UAdd, ast.USub,
    ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq,
)  # fmt: skip


_LONGEST = 500  # signs of a formula: Python reads sums of some thousands of terms by recursion


def check(formula: str, variables: tuple[str, ...]) -> None:
    """Raise ValueError, saying what is wrong, unless the formula uses only the variables and FUNCTIONS."""
    if len(formula) > _LONGEST:
        raise ValueError(f"is longer than {_LONGEST} signs")
    try:
        tree = ast.parse(formula, mode="eval")
    except (SyntaxError, ValueError):
        raise ValueError("is not a formula") from None
    called = [node.func for node in ast.walk(tree) if isinstance(node, ast.Call)]
    for node in ast.walk(tree):
        if not isinstance(node, _NODES) or (isinstance(node, ast.Compare) and len(node.ops) > 1):
            raise ValueError("uses more than numbers, + - * / **, one comparison at a time and functions")
        if isinstance(node, ast.Constant) and not isinstance(node.value, int | float):
            raise ValueError(f"has {node.value!r}, which is not a number")
        if isinstance(node, ast.Name) and node.id not in (*variables, "pi", *FUNCTIONS):
            raise ValueError(f"knows {', '.join((*variables, 'pi', *FUNCTIONS))}, but not {node.id}")
        if isinstance(node, ast.Call):
            _check_call(node)
        if isinstance(node, ast.Name) and node.id in FUNCTIONS and node not in called:
            raise ValueError(f"has {node.id} without arguments")

    try:
        evaluate(formula, np.array([0.5]), **dict.fromkeys(variables, np.array([0.5])))
    except (ArithmeticError, TypeError, ValueError) as error:
        raise ValueError(f"has no value: {error}") from None


def _check_call(call: ast.Call) -> None:
    """Raise ValueError unless one of FUNCTIONS is called with as many arguments as it takes."""
    if not isinstance(call.func, ast.Name) or call.func.id not in FUNCTIONS:
        raise ValueError(f"calls something that is not one of {', '.join(FUNCTIONS)}")
    name, given = call.func.id, len(call.args)
    if given != (wanted := _ARGUMENTS.get(name, 1)):
        raise ValueError(f"gives {name} {given} arguments, which takes {wanted}")


def evaluate(formula: str, like: Array, **variables: Array | float) -> Array:
    """The value of a checked formula, of the shape of `like`; not finite where it has none."""
    given = {name: np.asarray(value) for name, value in variables.items()}  # numbers would raise at 1/0
    names = {"__builtins__": {}, "pi": np.pi, **FUNCTIONS, **given}
    with np.errstate(all="ignore"):
        value = eval(_compiled(formula), names)  # checked: arithmetic and FUNCTIONS only
    return np.broadcast_to(np.asarray(value, dtype=float), like.shape).copy()


def _compiled(formula: str) -> CodeType:
    """The formula with real numbers for whole ones, whose powers would grow without bound."""
    tree = ast.parse(formula, mode="eval")
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant):
            node.value = float(node.value)  # type: ignore[arg-type]  # checked: a number
    return compile(tree, "formula", "eval")


class Block(Section):
    """A stretch of uniform density at time 0."""

    renamed = {"velocity": "use initial_velocity: a velocity is prescribed"}  # noqa: RUF012

    left: float
    """its left end, a number"""
    right: float
    """its right end, a number above `left`"""
    density: float = Field(gt=0.0, le=1.0)
    """rho, in (0, 1]"""
    initial_velocity: str
    'u at time 0, a formula of x and m, like "-x"'

    @field_validator("initial_velocity")
    @classmethod
    def _formula(cls, velocity: str) -> str:
        check(velocity, ("x", "m"))
        return velocity

    @model_validator(mode="after")
    def _extended(self) -> Self:
        if not self.left < self.right:
            raise ValueError(f"has right = {self.right!r} not above left = {self.left!r}")
        return self


class Macroscopic(Section):
    """A line of gluey matter, at most as dense as 1: blocks of it, or the bodies of the case as such."""

    parcels: int = Field(default=400, ge=2)
    """the number of parcels of equal mass, at least 2"""
    blocks: tuple[Block, ...] = ()
    """one section [[macroscopic.blocks]] each, from left to right; the bodies if not given"""
    force_per_mass: str = "0"
    'the force per mass on blocks, a formula of x, m (the mass left of x) and t, like "-x"'

    @field_validator("force_per_mass")
    @classmethod
    def _formula(cls, force: str) -> str:
        check(force, ("x", "m", "t"))
        return force

    @field_validator("blocks")
    @classmethod
    def _in_order(cls, blocks: tuple[Block, ...]) -> tuple[Block, ...]:
        for one, other in itertools.pairwise(blocks):
            if other.left < one.right:
                raise ValueError(
                    f"has a block from {other.left!r} that begins before the one to {one.right!r} ends"
                )
        return blocks
