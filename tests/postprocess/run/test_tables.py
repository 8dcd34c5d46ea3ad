"""Tables that someone has changed are refused in one line, which says what is wrong with them."""

from __future__ import annotations

from pathlib import Path
from zlib import crc32

import pytest

from fsi.errors import InputError
from fsi.postprocess.run.tables import read_table

HEADER = "step,t,body,x,y,angle,V_x,V_y,omega,F_x,F_y,T"
ROWS = [f"{step},{0.1 * step},{body},1,2,0,0,-1,0,0,-1,0" for step in range(3) for body in ("7", "low")]


def bodies(folder: Path, header: str = HEADER, rows: list[str] = ROWS) -> Path:
    """A table of two bodies."""
    path = folder / "bodies.csv"
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def test_a_table_as_a_run_has_written_it(tmp_path: Path) -> None:
    """Further columns may follow, and a run that goes on may have begun a row."""
    path = bodies(tmp_path, HEADER + ",S_xy", [row + ",0.5" for row in ROWS])
    complete = path.stat().st_size
    with path.open("a") as table:
        table.write("3,0.3,7,1,")
    assert list(read_table(path, complete)["step"]) == [0, 0, 1, 1, 2, 2]


def test_what_does_not_apply_at_an_instant_is_not_a_number(tmp_path: Path) -> None:
    path = tmp_path / "steps.csv"
    path.write_text("step,t,apparent_viscosity,stress\n0,0,nan,nan\n1,0.1,1.5,1e-14\n")
    assert list(read_table(path, None)["apparent_viscosity"].notna()) == [False, True]
    path.write_text("step,t,apparent_viscosity,stress\n0,0,nan,nan\n1,0.1,a,1e-14\n")
    with pytest.raises(InputError, match=r'apparent_viscosity = "a" in its row 2 is not a number'):
        read_table(path, None)


@pytest.mark.parametrize(
    ("header", "rows", "how"),
    [
        (HEADER.replace(",x,", ",xx,"), ROWS, r'a column is "xx" where "x" stood'),
        ("step,t,body,x", [",".join(row.split(",")[:4]) for row in ROWS], r'its column "y" is missing'),
        (HEADER, [ROWS[0].replace("-1", "a"), *ROWS[1:]], r'V_y = "a" in its row 1 is not a number'),
        (HEADER, [*ROWS[:3], ROWS[3][:20], *ROWS[4:]], "its row 4 has 8 cells under 12 columns"),
        (HEADER, [*ROWS[:3], *ROWS[4:]], "different numbers of bodies"),
        (HEADER, [ROWS[0] + ",5,6", *ROWS[1:]], "its row 1 has 14 cells under 12 columns"),
        (HEADER.rpartition(",")[0], ROWS, "its row 1 has 12 cells under 11 columns"),
        (HEADER, [*ROWS[:-1], ROWS[-1].replace("2,0.2", "2,inf")], "t = inf in its row 6 is not finite"),
        (HEADER, [*ROWS[2:], *ROWS[:2]], r"step = 0 in its row 5 comes after 2"),
        (HEADER, [row.replace("2,0.2", "2,0.0") for row in ROWS], r"t = 0.0 in its row 5 comes after 0.1"),
    ],
)
def test_a_table_that_was_changed(header: str, rows: list[str], how: str, tmp_path: Path) -> None:
    path = bodies(tmp_path, header, rows)
    with pytest.raises(InputError, match=how) as refused:
        read_table(path, None)
    assert "\n" not in str(refused.value)


def test_a_row_that_is_after_the_end_of_the_run(tmp_path: Path) -> None:
    """Whoever went on would write earlier times behind it."""
    path = bodies(tmp_path)
    assert len(read_table(path, None, 0.2)) == len(ROWS)
    with pytest.raises(InputError, match=r"t = 0\.2 in its last row is after t = 0\.1, the run's last"):
        read_table(path, None, 0.1)


@pytest.mark.parametrize(
    ("name", "columns"),
    [
        ("profiles", "step,t,m,x,rho,u,gamma"),
        ("contacts", "step,t,side,body,gap,gamma,impulse,solid_impulse"),
    ],
)
def test_columns_of_the_tables_of_two_models(name: str, columns: str, tmp_path: Path) -> None:
    path = tmp_path / f"{name}.csv"
    words = columns.split(",")
    row = ",".join(str(k) for k in range(len(words)))
    path.write_text(f"{columns}\n{row}\n")
    assert list(read_table(path, None)) == words
    path.write_text(f"{columns.replace(words[2], 'q')}\n{row}\n")
    with pytest.raises(InputError, match=f'a column is "q" where "{words[2]}" stood'):
        read_table(path, None)


def test_a_table_that_was_cut(tmp_path: Path) -> None:
    path = bodies(tmp_path)
    with pytest.raises(InputError, match="10 bytes are missing at its end"):
        read_table(path, path.stat().st_size + 10)


def test_a_table_whose_rows_are_sound_but_others(tmp_path: Path) -> None:
    """Two bodies of a step exchanged: all is as long, and each has the other's place."""
    path = bodies(tmp_path)
    written = crc32(path.read_bytes())
    assert len(read_table(path, None, checksum=written)) == len(ROWS)
    bodies(tmp_path, rows=[ROWS[1], ROWS[0], *ROWS[2:]])
    assert len(read_table(path, None)) == len(ROWS)  # as of older runs, which keep no checksum
    with pytest.raises(
        InputError, match=r"was changed .* \(its rows are others than were written\); run the"
    ):
        read_table(path, None, checksum=written)


def test_a_table_without_rows(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no rows yet; continue the run"):
        read_table(bodies(tmp_path, HEADER, []), None)


def test_no_table(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        read_table(tmp_path / "bodies.csv", None)
