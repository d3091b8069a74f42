"""TrajNet++: a JSON object a line, {"track": {"f": frame, "p": person, "x": ..., "y": ...}}, metres, and its scenes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data.readers.registry import Found
from bayeshunt.data.text_tables import read_text

__all__ = ["TrajNetReader"]

_WHAT = "a TrajNet++ file"
_FIX = 'expected lines like {"track": {"f": 0, "p": 1, "x": 0.0, "y": 0.0}}'


class TrajNetReader:
    """People by frame; the lines of scenes tell the rate, those of predictions are left out."""

    name = "trajnet"

    def accepts(self, path: Path, head: bytes) -> bool:
        """Return whether the file begins with a JSON object of a scene or a track."""
        begins = head.lstrip()[:12].replace(b" ", b"")
        return begins.startswith((b'{"scene"', b'{"track"'))

    def read(self, path: Path, *, columns: Mapping[str, str], keypoint: str | None) -> Found:
        """Read the file; see :class:`bayeshunt.data.readers.registry.TrackReader`."""
        for given, name in ((columns, "columns"), (keypoint, "keypoint")):
            if given:
                raise InputError(f"{path}: {_WHAT} names its own columns; leave out {name}={given!r}")
        rows: list[tuple[float, str, float, float]] = []
        rates: set[float] = set()
        predicted = 0
        for number, line in enumerate(read_text(path, _WHAT).splitlines(), 1):
            if not line.strip():
                continue
            kind, content = _parsed(line, f"{path}: line {number}")
            if kind == "track" and "prediction_number" in content:
                predicted += 1
            elif kind == "track":
                rows.append(_row(content, f"{path}: line {number}"))
            elif isinstance(content.get("fps"), (int, float)) and content["fps"] > 0:
                rates.add(float(content["fps"]))
        if not rows:
            raise DataError(f"{path}: holds no track; {_FIX}")
        notes = [f"{predicted} rows of predictions are left out"] if predicted else []
        frame = pd.DataFrame(rows, columns=["frame", "id", "x", "y"])
        return Found(frame, {"rate": rates.pop()} if len(rates) == 1 else {}, tuple(notes))


def _parsed(line: str, where: str) -> tuple[str, dict[str, Any]]:
    try:
        whole = json.loads(line)
        ((kind, content),) = whole.items()
        if kind in ("scene", "track") and isinstance(content, dict):
            return kind, content
    except (ValueError, AttributeError, RecursionError):
        pass
    raise DataError(f"{where}: neither a scene nor a track of {_WHAT}; {_FIX}")


def _row(content: dict[str, Any], where: str) -> tuple[float, str, float, float]:
    for name in "fxy":
        if isinstance(content.get(name), bool) or not isinstance(content.get(name), (int, float)):
            raise DataError(f"{where}: {name} is {content.get(name)!r}; expected a number")
    if not isinstance(content.get("p"), (int, str)):
        raise DataError(f"{where}: p is {content.get('p')!r}; expected the number of a person")
    return float(content["f"]), str(content["p"]), float(content["x"]), float(content["y"])
