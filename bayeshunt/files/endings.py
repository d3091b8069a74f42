"""What the ending of a file's name says that it holds: one rule for every file written, from Python or by a command."""

from __future__ import annotations

import os
from pathlib import Path

from bayeshunt.core.errors import InputError
from bayeshunt.files.atomic import check_path

__all__ = ["check_ending"]

#: What an ending says of a file: those of files that are written here, and others that people may ask for.
_KINDS = {
    ".parquet": "Parquet", ".json": "JSON", ".npz": "NPZ", ".html": "HTML", ".htm": "HTML", ".png": "PNG",
    ".svg": "SVG", ".xmlbif": "XMLBIF", ".xml": "XMLBIF", ".bif": "BIF", ".csv": "CSV", ".tsv": "TSV",
    ".xls": "Excel", ".xlsx": "Excel", ".npy": "NPY", ".txt": "text", ".md": "Markdown", ".toml": "TOML",
    ".pdf": "PDF", ".jpg": "JPEG", ".jpeg": "JPEG", ".zip": "ZIP", ".db": "SQLite", ".sqlite": "SQLite",
}  # fmt: skip


def check_ending(path: str | os.PathLike[str], what: str, ending: str) -> None:
    """Raise InputError if the name of a file to write ends as another kind of file; any unknown ending is taken.

    what, ending: what such files hold ("models") and how their names end (".json").
    """
    given = Path(check_path(path, "the name of a file to write", InputError))
    asked, written = _KINDS.get(given.suffix.lower()), _KINDS[ending]
    if asked not in (None, written):
        raise InputError(f"{given}: {what} are {written}, not {asked}; name it {given.with_suffix(ending)}")
