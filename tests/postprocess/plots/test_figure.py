"""How figures are saved."""

from itertools import pairwise
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from fsi.errors import InputError
from fsi.postprocess.plots.figure import (
    SUFFIXES,
    PlainNumbers,
    label_short,
    plain,
    plain_labels,
    plain_title,
    require_figure,
    saved_figure,
)


def test_a_picture_that_is_there_stays_until_the_new_one_is_complete(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disk that fills half-way through leaves the old picture, and nothing of the new one."""

    def full(_: Figure, path: Path, **__: object) -> None:
        path.write_bytes(b"half a pic")
        raise OSError(28, "No space left on device")

    (tmp_path / "a.png").write_bytes(b"the old one")
    monkeypatch.setattr(Figure, "savefig", full)
    with (
        pytest.raises(InputError, match=r"a\.png: No space left on device"),
        saved_figure(tmp_path / "a.png", (1.0, 1.0)),
    ):
        pass
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"a.png": b"the old one"}


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_figure_has_the_format_of_its_suffix(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    require_figure(path)
    with saved_figure(path, (1.0, 1.0)):
        pass
    begins = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
    assert path.read_bytes().startswith(begins[suffix])
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", ["a.foo", "a", "nowhere/a.png"])
def test_what_is_no_path_of_a_figure_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"give the path of a \.png, \.svg or \.pdf file"):
        require_figure(tmp_path / name)
    with pytest.raises(InputError, match="choose another path"), saved_figure(tmp_path / name, (1.0, 1.0)):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_picture_that_cannot_be_drawn_does_not_blame_its_path(tmp_path: Path) -> None:
    """A formula that is none is a mistake here: another path would not help."""
    with (
        pytest.raises(ValueError, match="Unknown symbol"),
        saved_figure(tmp_path / "a.png", (1.0, 1.0)) as figure,
    ):
        figure.text(0.0, 0.0, r"$\nothing$")


@pytest.mark.parametrize("name", ["$x_2$", r"two $$ and \alpha", r"a \$ and $", "one $", "_a", "_$a$"])
def test_names_are_drawn_letter_by_letter(name: str) -> None:
    """As wide as where nothing is read as a formula; and legends have them all."""
    figure = Figure()
    axes = figure.subplots()
    axes.plot([0.0], label=plain(name))
    (text,) = axes.legend().get_texts()
    raw = figure.text(0.0, 0.0, name, parse_math=False, fontsize=text.get_fontsize())
    assert text.get_window_extent().width == pytest.approx(raw.get_window_extent().width, abs=1.0)


def test_long_names_are_told_apart() -> None:
    """Of 31 letters 14 stay at both ends, of 30 all; what then is the same has numbers."""
    assert plain_labels(["a" * 30, "b" * 17 + "c" * 14]) == ["a" * 30, "b" * 14 + "…" + "c" * 14]
    same = [f"{'a' * 20}{k}{'z' * 20}" for k in range(3)]
    assert plain_labels(same) == [f"{'a' * 14}…{'z' * 14} ({k})" for k in (1, 2, 3)]
    assert plain_labels(["a$ " * 11]) == [r"a\$ a\$ a\$ a\$ a\$…\$ a\$ a\$ a\$ a\$ "]
    assert plain_title("word " * 9) == "word word word word word word word word\nword"
    assert max(map(len, plain_title("word " * 99).split("\n"))) <= 40
    assert plain_title("word " * 99).endswith(" …")


@pytest.mark.parametrize(("least", "most"), [(0.32, 0.41), (0.5, 0.50003), (9.4, 10.6), (2.4e-5, 1.55e-3)])
def test_labels_of_a_logarithmic_axis_do_not_meet(least: float, most: float) -> None:
    """In one of the two panels of a comparison; there are two at least."""
    figure = Figure(figsize=(11.0, 4.5), layout="constrained")
    _, axes = figure.subplots(1, 2)
    axes.loglog([least, most], [1.0, 2.0])
    axes.set_xlim(least, most)
    label_short(axes.xaxis)
    figure.draw_without_rendering()
    ticks = [*axes.xaxis.get_major_ticks(), *axes.xaxis.get_minor_ticks()]
    boxes = sorted(
        (
            tick.label1.get_window_extent()
            for tick in ticks
            if least <= tick.get_loc() <= most and tick.label1.get_text()
        ),
        key=lambda box: box.x0,
    )
    assert len(boxes) >= 2
    assert all(one.x1 < other.x0 for one, other in pairwise(boxes))


@pytest.mark.parametrize(
    ("values", "labels"),
    [
        ([1.0, 1.0000025], ["1", "1.0000025"]),
        ([0.1, 0.2, 0.1 + 0.2], ["0.1", "0.2", "0.3"]),
        ([2.4954431e16], ["2.49544e+16"]),
        ([10.0, 300000.0], ["10", "300000"]),
    ],
)
def test_numbers_have_the_digits_that_tell_them_apart(values: list[float], labels: list[str]) -> None:
    assert PlainNumbers().format_ticks(values) == labels
