"""The site builds without a network or a warning, and links lead somewhere, there and in a checkout."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from time import monotonic

import pytest

import fsi

ROOT = Path(__file__).parents[1]
MOST_SECONDS = 60.0


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


def test_links_lead_somewhere_in_a_checkout_too() -> None:
    """Those of pages and README to files: the site makes others of links to examples."""
    lost = []
    for page in (ROOT / "README.md", *(ROOT / "docs").glob("*.md")):
        targets = re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text(encoding="utf-8"))
        own = (target for target in targets if not re.match(r"[a-z]+:", target))
        lost += [(page.name, target) for target in own if not (page.parent / target).exists()]
    assert lost == []


def test_the_page_of_python_has_every_name_of_the_package() -> None:
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    told = set(re.findall(r"^::: (\S+)$", page, flags=re.MULTILINE))
    names = {name: getattr(fsi, name) for name in vars(fsi)["__all__"]}
    wholes = {name: {of.__module__, f"{of.__module__}.{of.__qualname__}"} for name, of in names.items()}
    assert [name for name, whole in wholes.items() if not whole & told] == []


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
