"""What can go wrong, and the exit code that each kind of it gives the command line."""

from typing import ClassVar


class FsiError(Exception):
    """Base of the errors whose message, one line, is meant for the user."""

    exit_code: ClassVar[int] = 3


class InputError(FsiError):
    """The user's input is wrong: the message names the key, the value and the remedy."""

    exit_code = 2


class SolveError(FsiError):
    """A solve, a mesh or a step failed; the last good state is kept."""

    exit_code = 3


class ValidationError(FsiError):
    """A computed value lies outside the tolerance of its reference."""

    exit_code = 4
