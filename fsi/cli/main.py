"""The command line as a whole.

Exit codes: 0 done, 2 wrong input, 3 a solve, mesh or step failed, 4 a validation failed, 70 a defect of the
program (EX_SOFTWARE of sysexits.h), 130 interrupted, 129 and 143 ended by SIGHUP and SIGTERM. Errors are one
line on stderr. Under `mpiexec` root alone prints; see `parallel.last_words` for how all ranks end together.
"""

import atexit
import gc
import sys
import traceback
from contextlib import suppress
from pathlib import Path
from typing import Annotated

from fsi.cli.loading import loading

DEFECT, INTERRUPTED = 70, 130
_BROKEN_OFF = dict.fromkeys(("run", "resume"), "; a run goes on with fsi resume") | dict.fromkeys(
    ("calibrate", "sweep"), "; it goes on when repeated"
)

try:
    with loading():
        import typer

        import fsi.parallel as parallel
        from fsi.cli.commands import PLACES, Group
        from fsi.cli.missing import explain
        from fsi.cli.streams import finish, prepare
        from fsi.errors import FsiError, InputError
        from fsi.machine.signals import Ended, heard
except KeyboardInterrupt:
    sys.stderr.write("error: interrupted\n")
    sys.exit(INTERRUPTED)


def _print_version(asked: bool) -> None:
    if asked:
        from importlib import metadata

        typer.echo(f"fsi-stokes {metadata.version('fsi-stokes')}")
        raise typer.Exit


app = typer.Typer(
    cls=Group,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    help="Rigid bodies moving in Stokes flow, resolved down to the lubrication film.\n\n"
    "Begin with: fsi cases, fsi check cases/disc_in_box.toml. Works under mpiexec -n 4 fsi ... as well.",
)


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """What stands before a command."""


def main() -> int:
    """Run the command line; returns the exit code."""
    prepare(silent=not parallel.is_root())  # help and tables once, not once a rank
    parallel.speak_with(_line)
    atexit.register(gc.freeze)  # what is left ends with the process, and needs no look for cycles
    if parallel.size() > 1:  # a rank in an exchange hears nothing: signals end each at once
        return finish(_command())
    with heard():
        return finish(_command())


def _command() -> int:
    try:
        _require_text(sys.argv)
        with loading():
            command = typer.main.get_command(app)
        code = command.main(sys.argv[1:] or ["--help"], prog_name="fsi", standalone_mode=False) or 0
        if code != INTERRUPTED:  # typer turns Ctrl-C into this exit code, and says nothing
            return int(code)
        return parallel.last_words(*_line(KeyboardInterrupt()))
    except (Exception, SystemExit, KeyboardInterrupt) as error:
        gone = isinstance(error.__context__, BrokenPipeError)
        if isinstance(error, SystemExit) and (gone or not error.code):
            return 0  # typer's, where the reader of standard output has gone, or the shell completes a word
        return parallel.last_words(*_line(error))


def _require_text(words: list[str]) -> None:
    """Raise InputError of bytes that are no letters here, as DOLFINx and VTK take no such paths."""
    with suppress(OSError):  # the folder that the shell is in has been removed
        words = [*words, str(Path.cwd())]
    for word in words:
        try:
            word.encode()
        except UnicodeEncodeError:
            remedy = "give it a name in UTF-8, or set LC_ALL=C.UTF-8 where it has one"
            raise InputError(f"{word}: has bytes that are no letters; {remedy}") from None


def _line(error: BaseException) -> tuple[str, int]:
    """The same as `_words`, with what would control the terminal, of names that are told, as its number."""
    words, exit_code = _words(error)
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in words), exit_code


def _words(error: BaseException) -> tuple[str, int]:
    """What to say of an error that ends the program, and the exit code."""
    match error:
        case FsiError():
            return f"error: {error}", error.exit_code
        case typer.TyperException():
            return f"error: {_usage(error)}", 2
        case KeyboardInterrupt():
            return f"error: interrupted{_goes_on()}", INTERRUPTED
        case Ended():
            return f"error: ended by {error.signal}{_goes_on()}", error.exit_code
    lacking = explain(error)
    if lacking is not None:
        return f"error: {lacking}", lacking.exit_code
    return f"error: {_defect(error)}", DEFECT


def _goes_on() -> str:
    """How what has been broken off goes on, of commands that keep what they have done."""
    return "".join(_BROKEN_OFF.get(word, "") for word in sys.argv[1:2])


def _defect(error: BaseException) -> str:
    """What went wrong in the program itself, on one line, and the file that has all of it."""
    import tempfile

    what = " ".join(f"a defect of the program, {type(error).__name__}: {error}".split())[:300]
    trace = "".join(traceback.format_exception(error))
    text = f"{sys.argv}\n{trace}".encode(errors="backslashreplace")
    try:
        with tempfile.NamedTemporaryFile(prefix="fsi-defect-", suffix=".txt", delete=False) as file:
            file.write(text)
        return f"{what}; please report it with {file.name}, which has the full text"
    except OSError:  # no room for it either
        place = traceback.extract_tb(error.__traceback__)[-1]
        return f"{what}, at {place.filename}:{place.lineno}; please report it"


def _usage(error: typer.TyperException) -> str:
    """What is wrong with the command line, and where its help is."""
    context = getattr(error, "ctx", None)
    if context is None:  # of an option that lacks its value: the first word tells the command
        command = " ".join(["fsi", *(word for word in sys.argv[1:2] if word in PLACES)])
    else:
        command = context.command_path
    said = error.format_message().rstrip(".").replace("Value error, ", "")  # as Pydantic begins
    return f"{said}; see {command} --help"
