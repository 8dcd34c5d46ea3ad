"""Functions of position, mass and time that a case file gives as formulas, like "where(t > 1, 2*m, 0)"."""

from __future__ import annotations

import ast
from types import CodeType

import numpy as np

from fsi.bodies.configuration import Array

FUNCTIONS = {
    "sin": np.sin, "cos": np.cos, "exp": np.exp, "sqrt": np.sqrt, "abs": np.abs, "sign": np.sign,
    "tanh": np.tanh, "minimum": np.minimum, "maximum": np.maximum, "where": np.where,
}  # fmt: skip
_NODES = (
    ast.Expression, ast.BinOp, ast.UnaryOp, ast.Compare, ast.Call, ast.Name, ast.Load, ast.Constant,
    ast.operator, ast.unaryop, ast.cmpop,
)  # fmt: skip


def check(formula: str, variables: tuple[str, ...]) -> None:
    """Raise ValueError, saying what is wrong, unless the formula uses only the variables and FUNCTIONS."""
    try:
        tree = ast.parse(formula, mode="eval")
    except (SyntaxError, ValueError):
        raise ValueError("is not a formula") from None
    for node in ast.walk(tree):
        if not isinstance(node, _NODES) or (isinstance(node, ast.Compare) and len(node.ops) > 1):
            raise ValueError("uses more than numbers, + - * / **, one comparison at a time and functions")
        if isinstance(node, ast.Constant) and not isinstance(node.value, int | float):
            raise ValueError(f"has {node.value!r}, which is not a number")
        if isinstance(node, ast.Name) and node.id not in (*variables, "pi", *FUNCTIONS):
            raise ValueError(f"knows {', '.join((*variables, 'pi', *FUNCTIONS))}, but not {node.id}")
        if isinstance(node, ast.Call) and (
            not isinstance(node.func, ast.Name) or node.func.id not in FUNCTIONS
        ):
            raise ValueError(f"calls something that is not one of {', '.join(FUNCTIONS)}")

    try:
        evaluate(formula, np.array([0.5]), **dict.fromkeys(variables, np.array([0.5])))
    except (ArithmeticError, TypeError, ValueError) as error:
        raise ValueError(f"has no value: {error}") from None


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
