"""A case file with the meaning of each key behind it, from the schema: what `fsi new` writes."""

import re
from pathlib import Path

import tomli_w

from fsi.case.reference import sections_of_case

_HEAD = "# `fsi check FILE` says what this case holds, `fsi keys` what else may stand here."
_WIDTH = 34  # letters before a meaning
_SECTION = re.compile(r"\[+([\w.]+)\]+")
_KEY = re.compile(r"([\w.]+)\s*=")


def commented(case_file: Path, name: str) -> str:
    """The text of a case with another name, without its own comments and expected numbers.

    Keys have their meanings behind them, once in each section of a kind.
    """
    meanings, told = _meanings(), set[tuple[str, str]]()
    lines = [_HEAD]
    section = ""
    for line in _own(case_file.read_text(encoding="utf-8")):
        if header := _SECTION.fullmatch(line):
            section = header[1]
        key = _KEY.match(line)
        if key is None:
            lines.append(line)
            continue
        of = _named(section, key[1])
        shown = tomli_w.dumps({"name": name}).strip() if of == ("", "name") else line
        meaning = "" if of in told else meanings.get(of, "")
        told.add(of)
        lines.append(f"{shown:<{_WIDTH}}  # {meaning}" if meaning else shown)
    return "\n".join(lines).rstrip() + "\n"


def _own(text: str) -> list[str]:
    """The lines of a case without comments and without what is expected of it, single blank lines between."""
    kept: list[str] = []
    section = ""
    for line in text.splitlines():
        if line.startswith("["):
            section = line
        plain = re.sub(r'\s*#(?=[^"]*$).*', "", line)
        if section == "[[expected]]" or line.startswith("#") or (not plain and kept[-1:] in ([], [""])):
            continue
        kept.append(plain)
    return kept


def _named(section: str, key: str) -> tuple[str, str]:
    """The section and the key of a line; in `walls.top = ...` of [domain] the key is `walls`."""
    first, _, rest = key.partition(".")
    if section == "" and rest:
        return first, rest.partition(".")[0]
    return section, first


def _meanings() -> dict[tuple[str, str], str]:
    """By section and key; of several shapes of a section the first that has the key."""
    found: dict[tuple[str, str], str] = {}
    for section in sections_of_case():
        title = _SECTION.search(section.title)
        for key in section.keys:
            found.setdefault((title[1] if title else "", key.name), " ".join(key.meaning.split()))
    return found
