"""The site builds without a warning, and what it tells a reader to type can be typed."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from time import monotonic
from unittest import mock

import pytest
import typer

from fsi.cli.main import app

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
MOST_SECONDS = 60.0


def commands(page: Path) -> list[str]:
    """What a page tells to type: spans and lines of code that begin with `fsi`."""
    text = page.read_text(encoding="utf-8").replace("\\\n", " ")
    spans = re.findall(r"`(fsi [a-z][^`]*)`", text)
    lines = re.findall(r"^ {4}(fsi [a-z].*)$", text, flags=re.MULTILINE)
    return [" ".join(re.split(r"\s{2,}#", found)[0].split()) for found in [*spans, *lines]]


def is_whole(command: str) -> bool:
    """Whether it is a command to type: no name alone, nothing in CAPITALS for what to put in, no dots."""
    words = command.split()[1:]
    named = any(not word.startswith("-") for word in words[1:])
    return named and not any(re.search(r"^[A-Z_]+$|\.\.\.|KEY|=A,", word) for word in words)


TYPED = sorted({command for page in PAGES for command in commands(page) if is_whole(command)})


def test_there_are_commands() -> None:
    assert len(TYPED) > 40


@pytest.mark.parametrize("command", TYPED)
def test_a_command_of_the_pages_is_understood(command: str) -> None:
    """Command, options and their kinds are known, and the cases that it names are there; it is not run."""
    words = shlex.split(command)[1:]
    main = typer.main.get_command(app)
    with mock.patch("typer.core.TyperCommand.invoke") as invoke:
        main.main(list(words), prog_name="fsi", standalone_mode=False)
    assert invoke.called
    for word in words:
        if word.startswith("cases/"):
            assert (ROOT / word).exists(), word


class Links(HTMLParser):
    """What a page refers to."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        wanted = {"a": "href", "img": "src", "link": "href", "script": "src"}.get(tag)
        self.found += [value for name, value in attrs if name == wanted and value]


def broken(page: Path) -> list[str]:
    """Its links within the site that lead nowhere."""
    links = Links()
    links.feed(page.read_text(encoding="utf-8"))
    targets = (re.split("[#?]", link)[0] for link in links.found)
    own = (target for target in targets if target and not re.match(r"[a-z]+:", target))
    return [target for target in own if not (page.parent / target).exists()]


@pytest.mark.slow
def test_the_site_builds_without_a_network_and_its_links_lead_somewhere(tmp_path: Path) -> None:
    nowhere = {f"{kind}_proxy": "http://127.0.0.1:9" for kind in ("http", "https")}
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"} | nowhere
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path / "site")]
    began = monotonic()
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "WARNING" not in done.stderr
    assert monotonic() - began < MOST_SECONDS
    pages = [page for page in (tmp_path / "site").rglob("*.html") if page.name != "404.html"]
    assert len(pages) > 25
    assert {page.name: found for page in pages if (found := broken(page))} == {}
    assert "8.29807" in (tmp_path / "site" / "validation.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_commands_of_the_first_pages_run_in_their_order(tmp_path: Path) -> None:
    """Those of README and of the start page; `fsi validate` and the calibration have tests of their own."""
    (tmp_path / "cases").symlink_to(ROOT / "cases")
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    for page in (ROOT / "README.md", ROOT / "docs" / "index.md"):
        for command in filter(is_whole, commands(page)):
            if command.split()[1] in ("validate", "calibrate"):
                continue
            line = [sys.executable, "-m", *shlex.split(command)]
            done = subprocess.run(
                line, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, f"{command}: {done.stderr}"
