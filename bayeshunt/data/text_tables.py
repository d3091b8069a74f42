"""Text tables as people have them: any separator, any header, decimal commas, comments, a byte order mark."""

from __future__ import annotations

import io
import os
import re
import warnings
from pathlib import Path

import numpy as np
import pandas as pd

from bayeshunt.core.errors import DataError
from bayeshunt.files.atomic import check_path

__all__ = ["as_numbers", "read_bytes", "read_text", "read_text_table", "same_name", "says_unit"]

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?$")
#: What stands for "no number" in logs and tracks, beside the words that pandas knows.
_EMPTY = ["", "-", "--", "?", "nan", "NaN", "NAN", "none", "None", "null", "NULL", "NA", "N/A", "n/a", "inf", "-inf"]
#: Columns of names, kept as they are written: gait 01 is not gait 1.
_NAMES = ("gait", "previousgait")
_LOOK = 200  # lines looked at to find the separator


def read_bytes(path: str | os.PathLike[str], expected: str) -> bytes:
    """Return what a file holds; DataError in one line if there is none. ``expected`` says what it should be."""
    name = check_path(path, f"the name of {expected}", DataError)
    try:
        return Path(name).read_bytes()
    except FileNotFoundError:
        raise DataError(f"{name}: no such file; give {expected}") from None
    except OSError as error:
        raise DataError(f"{name}: cannot be read ({error.strerror or error}); give {expected}") from None


def read_text(path: str | os.PathLike[str], expected: str) -> str:
    """Return the text of a file: UTF-8, UTF-16 with its mark, or else Latin-1; DataError if it is no text."""
    data = read_bytes(path, expected)
    try:
        if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
            return data.decode("utf-16")
        if b"\0" in data:
            raise DataError(f"{os.fspath(path)}: not a text table (it holds zero bytes); give {expected}")
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def read_text_table(path: str | os.PathLike[str], expected: str = "a table of text") -> pd.DataFrame:
    """Return a text table with columns named by its header, or "0", "1", ... where it has none; cells are text.

    The separator is found (comma, semicolon, tab, bar or blanks), a decimal comma too; lines that begin with # are
    comments. Raises DataError that names the line if rows have different numbers of cells.
    """
    name = os.fspath(path)
    lines = [line for line in read_text(path, expected).splitlines() if line.strip() and not line.startswith("#")]
    if not lines:
        raise DataError(f"{name}: the file is empty; give {expected}")
    separator = _separator(lines[:_LOOK], name)
    header = _header(_cells(lines[0], separator), _cells(lines[1], separator) if len(lines) > 1 else [])
    body = lines if header is None else lines[1:]
    width = len(header if header is not None else _cells(lines[0], separator))
    names = [i for i, column in enumerate(header or ()) if same_name(column) in _NAMES]
    frame = _parse(body, separator, width, name, 0 if header is None else 1, names)
    frame.columns = pd.Index(header if header is not None else [str(i) for i in range(width)])
    repeated = frame.columns[frame.columns.duplicated()]
    if len(repeated):
        hint = " (is the header missing?)" if _NUMBER.match(repeated[0]) else ""
        raise DataError(f"{name}: column {repeated[0]!r} stands twice; names must be unique{hint}")
    return frame


def as_numbers(values: pd.Series) -> np.ndarray:
    """Return the float64 numbers [N] of a column; NaN where a cell holds none, a decimal comma is one."""
    if pd.api.types.is_numeric_dtype(values.dtype) and not pd.api.types.is_complex_dtype(values.dtype):
        return values.to_numpy(dtype=float, na_value=np.nan)
    numbers = pd.to_numeric(values, errors="coerce").to_numpy(dtype=float, na_value=np.nan)
    lost = np.isnan(numbers)
    if lost.any():
        commas = values[lost].astype(str).str.strip().str.replace(",", ".", regex=False)
        numbers = numbers.copy()
        numbers[lost] = pd.to_numeric(commas, errors="coerce").to_numpy(dtype=float)
    return numbers


def same_name(name: str) -> str:
    """Return a column's name without case, unit in brackets and punctuation: "Pos X [m]" is "posx"."""
    return re.sub(r"[^a-z0-9]", "", re.sub(r"[\[(].*?[\])]", "", str(name)).lower())


def says_unit(name: str, unit: str) -> bool:
    """Return whether a column's name ends in a unit: "x_mm", "x [mm]" and "x(mm)" do in "mm"."""
    plain = str(name).lower().rstrip("])").replace("[", "_").replace("(", "_").replace(" ", "_")
    return plain.endswith(f"_{unit}")


def _separator(lines: list[str], name: str) -> str | None:
    """The separator that cuts most lines into the same number of cells (None: blanks)."""
    best: tuple[float, int, str | None] = (0.0, 1, None)
    for mark in ("\t", ";", "|", ",", None):
        widths = [len(_cells(line, mark)) for line in lines]
        common = max(set(widths), key=widths.count)
        score = widths.count(common) / len(widths)
        if common > 1 and score > best[0] + 1e-9:
            best = (score, common, mark)
    if best[1] == 1:
        raise DataError(f"{name}: no separator found; expected columns cut by comma, semicolon, tab, bar or blanks")
    return best[2]


def _cells(line: str, separator: str | None) -> list[str]:
    parts = line.split() if separator is None else line.split(separator)
    return [part.strip().strip('"').strip("'").strip() for part in parts]


def _header(first: list[str], second: list[str]) -> list[str] | None:
    """The names of the first line; None if it holds numbers, and is a row."""
    if all(_NUMBER.match(cell) or cell in _EMPTY for cell in first):
        return None
    if first and second and len(second) == len(first) + 1:  # R writes no name for the row numbers
        first = ["row", *first]
    return [cell or f"unnamed {i}" for i, cell in enumerate(first)]


def _parse(
    lines: list[str], separator: str | None, width: int, name: str, first: int, names: list[int]
) -> pd.DataFrame:
    text = io.StringIO("\n".join(lines))
    if not lines:
        return pd.DataFrame({i: pd.Series(dtype=str) for i in range(width)})
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pd.errors.ParserWarning)  # rows that are too long are looked for below
            frame = pd.read_csv(
                text, sep=r"\s+" if separator is None else separator, header=None, names=range(width), index_col=False,
                skipinitialspace=True, na_values=_EMPTY, low_memory=False, on_bad_lines="error", engine="c",
                dtype=dict.fromkeys(names, str),
            )  # fmt: skip
    except (pd.errors.ParserError, pd.errors.EmptyDataError, ValueError, OverflowError) as error:
        found = re.search(r"Expected (\d+) fields in line (\d+), saw (\d+)", str(error))
        if found is None:
            raise DataError(f"{name}: not a table that can be read ({str(error).splitlines()[0]})") from None
        wanted, line, seen = map(int, found.groups())
        raise DataError(f"{name}: row {line + first} has {seen} cells; expected {wanted}") from None
    wide = next((i for i, line in enumerate(lines) if len(_cells(line, separator)) > width), None)
    if wide is not None and '"' not in lines[wide]:
        seen = len(_cells(lines[wide], separator))
        extra = [cell for cell in _cells(lines[wide], separator)[width:] if cell]
        if extra:
            raise DataError(f"{name}: row {wide + 1 + first} has {seen} cells; expected {width}")
    return frame
