"""Pictures of the flow around an axis, on a plane through it: as in the plane, with coordinates r and z."""

from fsi.postprocess.render.planar import PlanarArtist
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.run import Run


class MeridianArtist(PlanarArtist):
    """Draws the flow of a run with an axis."""

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: as for the plane."""
        super().__init__(run, choice)
        self.panels = [(field.along("r", "z"), close) for field, close in self.panels]
