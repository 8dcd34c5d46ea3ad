"""Which gaps are meant: those that link bodies, or that between two sides of the user's choice."""

from fsi.errors import InputError

CLOSE = 0.1  # gaps below this many mean radii link bodies


def parse_sides(text: str, names: tuple[str, ...], walls: tuple[str, ...]) -> tuple[int, int]:
    """The sides of a gap in "3,7" or "disc,bottom": names, or numbers of bodies from 0. Raises InputError."""
    known, sides = [*names, *walls], []
    some = known if len(names) <= 6 else [names[0], "...", names[-1], *walls]
    listed = f"{', '.join(some)}, or 0 ... {len(names) - 1} for the bodies"
    for word in (word.strip() for word in text.split(",")):
        if word in known:
            sides.append(known.index(word))
        elif word.isdigit() and int(word) < len(names):
            sides.append(int(word))
        else:
            raise InputError(f"--gap {text}: there is no {word!r}; give two of {listed}")
    sides.sort()
    if len(sides) != 2 or sides[0] == sides[1] or sides[0] >= len(names):
        raise InputError(f"--gap {text}: give a body and another body or wall, of {listed}")
    return sides[0], sides[1]
