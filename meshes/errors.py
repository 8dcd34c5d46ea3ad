"""What goes wrong while a mesh is made, moved or read."""


class MeshError(Exception):
    """A mesh could not be made, or was refused: the message names the place and the remedy."""
