"""`fsi report`: one page about a run."""

from pathlib import Path
from typing import Annotated

import fsi.parallel as parallel
from fsi.cli.arguments import RunFolder, output_to, tell

EXAMPLE = "Example: fsi report runs/settling_discs -o settling.html"


def report(
    folder: RunFolder,
    output: Annotated[Path | None, output_to("A .html file.", "report.html in the run folder")] = None,
) -> None:
    """Write one HTML file about a run: case, pictures, animation, checks, tables, provenance.

    It opens from disk without a network. A run that was killed half-way is reported as far as it came.
    """
    from fsi.postprocess.report import write_report
    from fsi.postprocess.run.run import open_run

    path = output or folder / "report.html"
    parallel.on_root(lambda: write_report(open_run(folder), path))
    tell(f"wrote {path}")
