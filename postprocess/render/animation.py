"""Pictures into files: one PNG, or many as MP4 or GIF, each to a temporary name that is then renamed."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from fsi.errors import InputError

STILLS, MOVIES = (".png",), (".mp4", ".gif")
_PER_SECOND = 8

type Picture = NDArray[np.uint8]


def require_suffix(output: Path) -> None:
    """Raise InputError unless pictures can be written there."""
    if output.suffix not in (*STILLS, *MOVIES) or not output.absolute().parent.is_dir():
        raise InputError(
            f"output = {output}: give the path of a .png, .mp4 or .gif file in a folder that exists"
        )


def write_pictures(pictures: Iterable[Picture], output: Path) -> None:
    """Write pictures of one size, (height, width, 3) each, as they come. Raises InputError."""
    temporary = output.with_name(f".partial-{output.name}")
    try:
        {".png": _write_png, ".mp4": _write_mp4, ".gif": _write_gif}[output.suffix](pictures, temporary)
        temporary.replace(output)
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror or error}; choose another path") from None
    finally:
        temporary.unlink(missing_ok=True)


def _write_png(pictures: Iterable[Picture], path: Path) -> None:
    for picture in pictures:
        Image.fromarray(picture).save(path, format="PNG", compress_level=3)


def _write_mp4(pictures: Iterable[Picture], path: Path) -> None:
    """H.264, which browsers and slides show; it wants even sizes."""
    import imageio_ffmpeg

    frames = iter(pictures)
    first = _even(next(frames))
    size = (first.shape[1], first.shape[0])
    writer = imageio_ffmpeg.write_frames(
        str(path),
        size,
        fps=_PER_SECOND,
        codec="libx264",
        quality=8,
        macro_block_size=2,
        ffmpeg_log_level="error",
    )
    writer.send(None)
    writer.send(first)
    for picture in frames:
        writer.send(_even(picture))
    writer.close()


def _even(picture: Picture) -> Picture:
    return np.ascontiguousarray(picture[: picture.shape[0] // 2 * 2, : picture.shape[1] // 2 * 2])


def _write_gif(pictures: Iterable[Picture], path: Path) -> None:
    frames = [Image.fromarray(picture).quantize(128) for picture in pictures]
    frames[0].save(
        path, format="GIF", save_all=True, append_images=frames[1:], duration=1000 // _PER_SECOND, loop=0
    )
