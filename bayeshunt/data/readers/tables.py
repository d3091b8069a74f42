"""Tables of tracks: tidy CSV of any separator, Parquet, and rows of frame, id, x, y without a header."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.errors import DataError, InputError, did_you_mean
from bayeshunt.data.log_clock import seconds_of
from bayeshunt.data.readers.registry import Found
from bayeshunt.data.text_tables import as_numbers, read_text_table, same_name, says_unit
from bayeshunt.files import parquet

__all__ = ["ParquetReader", "TextReader", "guess_columns"]

#: What a column may be called, without case and punctuation; the first that a table has is taken.
_NAMES: dict[str, tuple[str, ...]] = {
    "x": ("x", "posx", "xpos", "positionx", "xm", "xcm", "xmm", "xpx", "xpixel", "centroidx", "cx", "xcoord", "px",
          "xworld"),
    "y": ("y", "posy", "ypos", "positiony", "ym", "ycm", "ymm", "ypx", "ypixel", "centroidy", "cy", "ycoord", "py",
          "yworld"),
    "id": ("id", "trackid", "track", "individual", "individualid", "agent", "agentid", "animal", "animalid", "ped",
           "pedid", "pedestrian", "pedestrianid", "person", "personid", "objectid", "object", "identity", "name"),
    "time": ("time", "t", "times", "timestamp", "timesec", "seconds", "sec", "secs", "elapsed", "datetime", "date",
             "timems", "timestampms", "tms", "timestampus", "timestampns", "stamp", "stampns", "utc"),
    "frame": ("frame", "frameid", "frameno", "framenumber", "framenum", "frames", "framenr", "step", "index"),
    "heading": ("heading", "theta", "yaw", "angle", "orientation", "bodyangle", "dir", "direction", "headingrad",
                "headingdeg", "thetadeg", "yawdeg", "angledeg", "orientationdeg", "thetarad", "yawrad", "anglerad",
                "orientationrad"),
    "confidence": ("confidence", "likelihood", "score", "probability", "prob", "certainty"),
}  # fmt: skip
_UNITS = ("mm", "cm", "m", "px")
_EXPECTED = "a file of tracks"


class TextReader:
    """CSV, TSV or blanks: columns by name, or frame, id, x, y where there is no header."""

    name = "text"

    def accepts(self, path: Path, head: bytes) -> bool:
        """Return whether the file looks like text."""
        return b"\0" not in head or head[:2] in (b"\xff\xfe", b"\xfe\xff")

    def read(self, path: Path, *, columns: Mapping[str, str], keypoint: str | None) -> Found:
        """Read the file; see :class:`bayeshunt.data.readers.registry.TrackReader`."""
        return _tidy(read_text_table(path, _EXPECTED), str(path), columns, keypoint)


class ParquetReader:
    """Parquet of any program, columns by name."""

    name = "parquet"

    def accepts(self, path: Path, head: bytes) -> bool:
        """Return whether the file begins as Parquet does."""
        return head.startswith(b"PAR1")

    def read(self, path: Path, *, columns: Mapping[str, str], keypoint: str | None) -> Found:
        """Read the file; see :class:`bayeshunt.data.readers.registry.TrackReader`."""
        table, record = parquet.read(path, what="a table of tracks", fix="give a file of tracks")
        frame: pd.DataFrame = table.to_pandas()
        found = _tidy(frame, str(path), columns, keypoint)
        known = _ingested(frame, record or {})
        if known is None:
            return found
        said = f"x and y in {known['unit']}, as bayeshunt ingest tracks has written them"
        return Found(found.frame.assign(scene=frame["scene"].to_numpy()), notes=(said,), ingested=known)


def _ingested(frame: pd.DataFrame, record: Mapping[str, Any]) -> dict[str, Any] | None:
    """What is known of a table that bayeshunt has written; None for one of another program."""
    sources = record.get("sources", [record] if "reader" in record else [])
    units = frame["unit"].unique().tolist() if "unit" in frame else ["m"]
    if not sources or "scene" not in frame or len(units) != 1 or not isinstance(units[0], str):
        return None
    kept = {key: record[key] for key in ("licence", "citation") if key in record}
    return {"unit": units[0], "sources": sources, **kept}


def guess_columns(names: list[str], given: Mapping[str, str], source: str) -> dict[str, str]:
    """Return the column of each meaning that can be named: those given, and those whose names say it.

    Raises DataError if x or y cannot be found, or a given one is not there.
    """
    for meaning, name in given.items():
        if meaning not in _NAMES:
            raise InputError(f"columns: unknown meaning {meaning!r}; expected one of {', '.join(_NAMES)}"
                             f"{did_you_mean(meaning, _NAMES, listed=False)}")  # fmt: skip
        if name not in names:
            raise DataError(f"{source}: column {name!r} is missing; the table has {', '.join(map(str, names))}"
                            f"{did_you_mean(name, names, listed=False)}")  # fmt: skip
    plain = {same_name(name): name for name in reversed(names)}
    found = {meaning: given[meaning] for meaning in _NAMES if meaning in given}
    for meaning, known in _NAMES.items():
        hit = next((plain[name] for name in known if name in plain and plain[name] not in found.values()), None)
        if meaning not in found and hit is not None:
            found[meaning] = hit
    _by_ending(names, found)
    for meaning in ("x", "y"):
        if meaning not in found:
            raise DataError(
                f"{source}: no column {meaning!r} found among {', '.join(map(str, names))}; "
                f'name it: columns={{"{meaning}": ...}}, on the command line --columns {meaning}=NAME'
            )
    return found


def _by_ending(names: list[str], found: dict[str, str]) -> None:
    """Where nothing is called x or y, the only pair that ends so: "pt1_cam1_X", "pt1_cam1_Y"."""
    if "x" in found or "y" in found:
        return
    for name in names:
        twin = next((n for n in names if n.lower() == name.lower()[:-1] + "y"), None)
        if name.lower().endswith("x") and twin is not None:
            found.update(x=name, y=twin)
            return


def _tidy(table: pd.DataFrame, source: str, columns: Mapping[str, str], keypoint: str | None) -> Found:
    if keypoint is not None:
        raise InputError(f"{source}: a table has no keypoints; name the columns of the point: columns={{...}}")
    names = list(map(str, table.columns))
    table.columns = pd.Index(names)
    if names == [str(i) for i in range(len(names))] and not columns:
        if len(names) != 4:
            raise DataError(f"{source}: {len(names)} columns without names; expected frame, id, x, y, or a header")
        found = {"frame": "0", "id": "1", "x": "2", "y": "3"}
        said = "no header: the columns are taken as frame, id, x, y"
    else:
        found = guess_columns(names, columns, source)
        said = "columns: " + ", ".join(f"{meaning} = {name}" for meaning, name in found.items())
    frame = pd.DataFrame({m: as_numbers(table[name]) for m, name in found.items() if m not in ("id", "time")})
    if "time" in found:
        clock = seconds_of(table[found["time"]], None, source, slowest=math.inf)
        frame["time"] = clock.seconds
        said += "" if clock.note.startswith("time in s ") else f"; {clock.note}"
    if "id" not in found:
        _check_alone(frame, names, source)
    frame["id"] = table[found["id"]].to_numpy() if "id" in found else "0"
    claims: dict[str, Any] = {"rate": _rate(frame)} if "time" in frame else {}
    claims["angle"] = "deg" if "heading" in found and says_unit(found["heading"], "deg") else None
    claims["unit"] = next((u for u in _UNITS if says_unit(found["x"], u) and says_unit(found["y"], u)), None)
    return Found(frame, {k: v for k, v in claims.items() if v}, (said,))


def _check_alone(frame: pd.DataFrame, names: list[str], source: str) -> None:
    """Raise DataError if most rows share their time with others: one individual is at one place at a time."""
    clocks = [clock for clock in ("frame", "time") if clock in frame]
    placed = frame[np.isfinite(frame[["x", "y", *clocks]]).all(axis=1)]
    shared = int(placed[clocks].duplicated(keep=False).sum()) if clocks else 0
    if shared > 0.5 * len(placed):
        raise DataError(
            f"{source}: several rows at one time ({shared} of {len(placed)}) and no id found among {', '.join(names)}; "
            'name the column that tells individuals apart: columns={"id": ...} (--columns id=NAME)'
        )


def _rate(frame: pd.DataFrame) -> float | None:
    """The rate [1/s] that the time column speaks of, if its unit is seconds."""
    gaps = frame.groupby("id", sort=False)["time"].diff().to_numpy()
    gaps = gaps[np.isfinite(gaps) & (gaps > 0)]
    return float(1.0 / np.median(gaps)) if gaps.size else None
