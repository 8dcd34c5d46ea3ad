"""What can go wrong, and the exit code that each kind of it gives the command line."""

from typing import Any, ClassVar


class FsiError(Exception):
    """Base of the errors whose message, one line, is meant for the user."""

    exit_code: ClassVar[int] = 3

    def __str__(self) -> str:
        """The message on one line; names of files and what libraries say may have more."""
        return " ".join(super().__str__().splitlines())


class InputError(FsiError):
    """The user's input is wrong: the message names the key, the value and the remedy."""

    exit_code = 2


class SolveError(FsiError):
    """A solve, a mesh or a step failed; the last good state is kept."""

    exit_code = 3


class RefusedError(SolveError):
    """A solution is less accurate than any may be; whoever knows the case adds what to do about it."""


class ValidationError(FsiError):
    """A computed value lies outside the tolerance of its reference."""

    exit_code = 4


def refuse_taken(name: str, there: Any, new: Any) -> None:
    """Raise ValueError where a name in a registry is that of something else; what is loaded anew may have it.

    there, new: classes or functions, which module and qualified name tell apart.
    """
    if (place := _place(there)) != _place(new):
        raise ValueError(f'"{name}": is the name of {place} already; choose another one for {_place(new)}')


def _place(entry: Any) -> str:
    return f"{entry.__module__}.{entry.__qualname__}"


def apart(value: float, bound: float) -> str:
    """A value beyond a bound, with as many digits as put it beyond the bound, at least two."""
    texts = (f"{value:.{digits}g}" for digits in range(2, 17))
    beyond = (text for text in texts if float(text) != bound and (float(text) > bound) == (value > bound))
    return next(beyond, repr(value))
