"""The section [reduced] of a case file: laws of gaps, and the drag of bodies by themselves."""

import math
from pathlib import Path
from typing import ClassVar, override

from fsi.case.section import NotNegative, Positive, Section, Text
from fsi.errors import InputError

# Laws of gaps, by name or as files.
LAW_KEYS = ("law", "wall_law", "shear_law", "wall_shear_law", "rotation_law", "wall_rotation_law")


class Reduced(Section):
    """The reduced model: which laws, which drag."""

    renamed: ClassVar[dict[str, str]] = {"scheme": "use time.scheme", "step": "use time.step"}

    law: Text = "exact"
    wall_law: Text | None = None
    """the law of the gaps to walls, as `law`; the same if not given"""
    shear_law: Text | None = None
    """the law of surfaces that slide past each other, a name or the path of a law file, or leave it out"""
    rotation_law: Text | None = None
    """the law of bodies that roll on each other, a name or the path of a law file, or leave it out"""
    wall_shear_law: Text | None = None
    """the law of sliding along walls, as `shear_law`; the same if not given"""
    wall_rotation_law: Text | None = None
    """the law of turning beside walls, as `rotation_law`; the same if not given"""
    drag: NotNegative | None = None
    """the drag >= 0 over mu V of discs (needed, or `drag_from`), mu a V of spheres (6 pi if not given)"""
    drag_from: Text | None = None
    """in place of `drag`, the path of a drag file that `fsi resistance --drag` has written, or leave it
    out"""
    cutoff: Positive | None = None
    """the gap beyond which bodies do not feel each other, a length > 0, or leave it out"""
    extrapolate: bool = False
    """true to use a law file outside the range of its gaps, false to stop there"""

    @classmethod
    @override
    def describe(cls, key: str) -> str | None:
        if key != "law":
            return super().describe(key)
        from fsi.lubrication.named_laws import names_of_laws

        return f"the law of the gaps: {names_of_laws()} or the path of a law file"

    def drag_of_bodies(self, *, spheres: bool) -> float:
        """Of a body by itself over mu V, for spheres over mu a V. Raises InputError where none is known."""
        if self.drag is not None:
            return self.drag
        if self.drag_from is not None:
            from fsi.case.drag_file import read_drag_file

            return read_drag_file(Path(self.drag_from)).drag
        if not spheres:
            raise InputError(
                "reduced.drag: missing; give the drag of a disc over mu V, some 10: a lone disc in unbounded "
                "fluid has none (Stokes's paradox), or a file of `fsi resistance --drag` by reduced.drag_from"
            )
        return 6.0 * math.pi

    @property
    def laws(self) -> dict[str, str]:
        """The law of each kind of gap, by its key: a name, or the path of a law file."""
        asked = {key: getattr(self, key) or getattr(self, key.removeprefix("wall_")) for key in LAW_KEYS}
        return {key: law for key, law in asked.items() if law is not None}

    def digests(self) -> dict[str, str]:
        """Those of laws in files, as far as there are such, by their keys. Raises InputError: one is none."""
        from fsi.case.law_file import read_law_file
        from fsi.lubrication.named_laws import LAWS

        paths = {key: Path(law) for key, law in self.laws.items() if law not in LAWS}
        return {key: read_law_file(path).digest() for key, path in paths.items() if path.is_file()}
