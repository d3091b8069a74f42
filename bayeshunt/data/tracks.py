"""Tracks of people and animals: one table for every format, in metres and seconds, y up.

Columns: ``id``, ``time`` [s], ``x``, ``y`` [m; px or body lengths where no scale is given, then a column ``unit``
says so], ``heading`` [rad counter-clockwise, NaN where the file has none], ``confidence`` (NaN where unknown) and
``scene`` (the file). A row that has no place is left out; rows are sorted by id and time.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_number
from bayeshunt.core.errors import DataError, InputError, warn
from bayeshunt.core.geometry import wrap
from bayeshunt.data.readers.keypoints import one_point
from bayeshunt.data.readers.registry import Found, find_reader
from bayeshunt.files import parquet
from bayeshunt.files.atomic import check_target
from bayeshunt.files.records import digest_of_file

__all__ = ["COLUMNS", "UNITS", "load", "read_tracks", "save", "tracks", "validate"]

#: The columns of every table of tracks.
COLUMNS = ("id", "time", "x", "y", "heading", "confidence", "scene")
#: Metres of one unit; None: known only with a scale.
UNITS: dict[str, float | None] = {"m": 1.0, "cm": 0.01, "mm": 0.001, "px": None, "body": None}

#: A place of less confidence may be anywhere.
_DOUBTED = 0.5
_EXPECTED = "a table of tracks"
_FIX = "give a file made by: bayeshunt ingest tracks"


@checked
def read_tracks(
    path: str | os.PathLike[str],
    rate: float | None = None,
    unit: str | None = None,
    scale: float | None = None,
    y: str | None = None,
    *,
    columns: Mapping[str, str] | None = None,
    keypoint: str | None = None,
    least_confidence: float = 0.0,
    degrees: bool = False,
    reader: str | None = None,
) -> pd.DataFrame:
    """Read recorded tracks of any known format (see :func:`bayeshunt.register_reader`).

    rate: rows (or frames) per second; needed unless the table has a time in seconds. It wins over what the file says.
    unit: of x and y in the file, "m", "cm", "mm", "px" or "body" (body lengths). A file of ``bayeshunt ingest tracks``
        knows it.
    scale: metres of one pixel, or of one body; without it x and y stay in pixels, or bodies.
    y: "up" or "down" (images); by default as the format counts, down for pixels.
    columns: names of columns by meaning ("x", "y", "id", "time", "frame", "heading", "confidence"), where they
        cannot be guessed. keypoint: the body part to follow; by default the centroid weighted by confidence.
    least_confidence: rows below are left out. degrees: the heading of the file is in degrees.
    reader: name of the format, where the file does not show it.

    What was read, guessed, left out and claimed by the file stands in ``attrs["bayeshunt"]``.
    Raises InputError if unit or rate is missing (it shows what the file claims), DataError for a damaged file.
    """
    source = os.fspath(path)
    check_number(least_confidence, "least_confidence", "a share")
    chosen = find_reader(path, reader)
    found = chosen.read(Path(path), columns=columns or {}, keypoint=keypoint)
    table = _table(found, source, chosen.name, rate, unit, scale, y, least_confidence, degrees)
    table.attrs[parquet.PROVENANCE_KEY]["sha256"] = digest_of_file(path)
    return table


def tracks(
    dataset: Any,
    rate: float | None = None,
    unit: str | None = None,
    scale: float | None = None,
    y: str | None = None,
    *,
    keypoint: str | None = None,
    least_confidence: float = 0.0,
    scene: str = "dataset",
) -> pd.DataFrame:
    """Return the table of tracks of an xarray Dataset with ``position`` over time and space, as ``movement`` makes it.

    Dimensions keypoints and individuals may be missing; ``confidence`` may be there. The rest as for
    :func:`read_tracks`; rate: by default the dataset's own time, where its attributes say that it is in seconds.
    """
    position = _variable(dataset, "position")
    order = [d for d in ("individuals", "time", "keypoints") if d in position.dims]
    extra = [d for d in position.dims if d not in (*order, "space")]
    if "time" not in position.dims or "space" not in position.dims or extra:
        raise DataError(f"{scene}: position has dimensions {', '.join(map(str, position.dims))}; expected time, space "
                        "and perhaps keypoints and individuals")  # fmt: skip
    places = np.asarray(position.sel(space=["x", "y"]).transpose(*order, "space").to_numpy(), dtype=float)
    sure = dataset.get("confidence")
    weights = None if sure is None else np.asarray(sure.transpose(*order).to_numpy(), dtype=float)
    for axis, name in ((0, "individuals"), (2, "keypoints")):
        if name not in order:
            places = np.expand_dims(places, axis)
            weights = None if weights is None else np.expand_dims(weights, axis)
    ids, names = (
        [str(v) for v in position[d].values] if d in position.coords else [str(i) for i in range(places.shape[a])]
        for d, a in (("individuals", 0), ("keypoints", 2))
    )
    frames = np.arange(places.shape[1])
    points, note = one_point(places, weights, names, ids, frames, keypoint)
    claims = {k: dataset.attrs[k] for k in ("fps", "time_unit", "source_software") if k in dataset.attrs}
    if str(claims.get("time_unit", "")).startswith("s") and "time" in position.coords:
        points["time"] = np.tile(np.asarray(position["time"].to_numpy(), dtype=float), len(ids))
    return _table(Found(points, claims, (note,), y="down"), scene, "xarray", rate, unit, scale, y, least_confidence)


def _variable(dataset: Any, name: str) -> Any:
    try:
        found = dataset[name]
        found.dims  # noqa: B018
    except (KeyError, TypeError, IndexError, AttributeError):
        kind = type(dataset).__name__
        raise InputError(f"dataset: expected an xarray Dataset with {name!r}, got a value of type {kind}") from None
    return found


def _table(
    found: Found, source: str, reader: str, rate: float | None, unit: str | None, scale: float | None,
    y: str | None, least_confidence: float, degrees: bool = False,
) -> pd.DataFrame:  # fmt: skip
    """The table of tracks of what a reader found."""
    own = found.ingested or {}
    unit = _known_unit(unit, own.get("unit"), source)
    if unit is None and rate is None and not _tells_time(found.frame):
        raise InputError(f"{source}: neither rate (rows per second) nor unit is given{_claimed(found.claims)}; say "
                         f"rate= (--rate) and unit= (--unit {'|'.join(UNITS)})")  # fmt: skip
    metres, kept = _unit(unit, scale, found.claims, source)
    down = found.y == "down" or (unit == "px" and not own)
    facing = y if y is not None else ("down" if down else "up")
    if facing not in ("up", "down"):
        raise InputError(f"y: expected 'up' or 'down', got {y!r}")
    frame, dropped = _clean(found.frame, least_confidence)
    if frame.empty:
        raise DataError(f"{source}: no row has a place")
    sign = -1.0 if facing == "down" else 1.0
    turn = math.radians(1.0) if degrees or found.claims.get("angle") == "deg" else 1.0
    heading = frame["heading"].to_numpy() * turn if "heading" in frame else np.full(len(frame), np.nan)
    _check_heading(heading, source)
    time, notes = _times(frame, rate, found.claims, source)
    table = pd.DataFrame(
        {
            "id": _ids(frame["id"]), "time": time, "x": frame["x"].to_numpy() * metres,
            "y": sign * frame["y"].to_numpy() * metres,
            "heading": wrap(np.where(np.isfinite(heading), sign * heading, np.nan)),
            "confidence": frame["confidence"].to_numpy() if "confidence" in frame else np.nan,
            "scene": frame["scene"].to_numpy() if "scene" in frame else Path(source).stem,
        }
    )  # fmt: skip
    if kept != "m":
        table["unit"] = kept
    table = table.sort_values(["scene", "id", "time"], key=_scenes_as_they_come, kind="stable", ignore_index=True)
    twice = table.duplicated(["scene", "id", "time"]).to_numpy()
    dropped["same id and time"] = int(twice.sum())
    table = table[~twice].reset_index(drop=True)
    table.attrs[parquet.PROVENANCE_KEY] = {
        "file": Path(source).name, "reader": reader, "rate": rate, "unit": unit, "scale": scale, "y": facing,
        "claims": {k: v for k, v in found.claims.items() if k != "keypoints"},
        "notes": [*found.notes, *notes, f"y of the file points {facing}", *_unsure(table, least_confidence)],
        "dropped": {k: v for k, v in dropped.items() if v}, **{k: v for k, v in own.items() if k != "unit"},
    }  # fmt: skip
    return table


def _unsure(table: pd.DataFrame, least: float) -> list[str]:
    """What to do about places that the file itself doubts, where they are more than a few."""
    count = int((table["confidence"].to_numpy(dtype=float) < _DOUBTED).sum())
    if least > 0 or count < 0.01 * len(table):
        return []
    return [f"{count} rows have a confidence below {_DOUBTED:g} and may leap: least_confidence={_DOUBTED:g} "
            f"(--least-confidence {_DOUBTED:g}) leaves them out"]  # fmt: skip


def _scenes_as_they_come(column: pd.Series) -> pd.Series:
    return pd.Series(pd.factorize(column)[0], column.index) if column.name == "scene" else column


def _known_unit(unit: str | None, known: str | None, source: str) -> str | None:
    """The unit given, or the one that the file itself knows; InputError where they differ."""
    if None not in (unit, known) and unit != known:
        raise InputError(
            f"{source}: x and y are in {known}, bayeshunt ingest tracks has written them; got unit {unit!r}"
        )
    return unit if known is None else known


def _unit(unit: str | None, scale: float | None, claims: Mapping[str, Any], source: str) -> tuple[float, str]:
    """Metres of one unit of the file and the unit of the table: (0.01, "m"), (1.0, "px")."""
    if unit not in UNITS:
        problem = "unit is not given" if unit is None else f"unknown unit {unit!r}"
        claimed = _claimed(claims, with_rate=False)
        raise InputError(f"{source}: {problem}{claimed}; expected one of {', '.join(UNITS)}: unit= (--unit)")
    metres, said = UNITS[unit], claims.get("unit")
    if said in UNITS and said != unit:
        warn(f"{source}: the file says that x and y are in {said}, but they are read in {unit} as given; "
             f"if the file is right: unit='{said}' (--unit {said})")  # fmt: skip
    if metres is not None:
        if scale is not None:
            raise InputError(f"{source}: scale is for px or body; x and y are in {unit}")
        return metres, "m"
    if scale is None:
        return 1.0, unit
    number = check_number(scale, "scale", f"metres of one {unit}, > 0")
    if number <= 0:
        raise InputError(f"scale: expected metres of one {unit}, > 0, got {scale}")
    return number, "m"


def _claimed(claims: Mapping[str, Any], *, with_rate: bool = True) -> str:
    """What the file itself says of rate, unit and scale; "" for nothing."""
    rate, unit = claims.get("rate", claims.get("fps")), claims.get("unit")
    said = [f"{float(rate):g} per second"] if rate and with_rate else []
    said += [f"unit {unit}"] if unit else []
    said += [f"{claims['cm_per_pixel']:g} cm per pixel"] if "cm_per_pixel" in claims else []
    return f" (the file says {', '.join(said)})" if said else ""


def _tells_time(frame: pd.DataFrame) -> bool:
    return "time" in frame and bool(np.isfinite(frame["time"].to_numpy()).all())


def _clean(frame: pd.DataFrame, least_confidence: float) -> tuple[pd.DataFrame, dict[str, int]]:
    """The rows that have a place, and how many were left out for which reason."""
    place = np.isfinite(frame["x"].to_numpy()) & np.isfinite(frame["y"].to_numpy())
    named = frame["id"].notna().to_numpy()
    sure = np.ones(len(frame), dtype=bool)
    if "confidence" in frame and least_confidence > 0:
        sure = ~(frame["confidence"].to_numpy() < least_confidence)
    reasons = {"no place": ~place, "no id": place & ~named, "low confidence": place & named & ~sure}
    kept = frame[place & named & sure]
    return kept, {reason: int(rows.sum()) for reason, rows in reasons.items()}


def _check_heading(heading: np.ndarray, source: str) -> None:
    beyond = np.abs(heading[np.isfinite(heading)]) > 6.2832
    if beyond.mean() > 0.05 if beyond.size else False:
        raise InputError(f"{source}: headings go beyond a full turn in radians; if they are degrees: degrees=True "
                         "(--angle deg)")  # fmt: skip


def _ids(values: pd.Series) -> np.ndarray:
    """Whole numbers where all ids are, else text."""
    numbers = pd.to_numeric(values, errors="coerce").to_numpy(dtype=float, na_value=np.nan)
    if np.isfinite(numbers).all() and (numbers == np.floor(numbers)).all() and (np.abs(numbers) < 2**53).all():
        return numbers.astype(np.int64)
    return values.astype(str).to_numpy(dtype=object)


def _times(
    frame: pd.DataFrame, rate: float | None, claims: Mapping[str, Any], source: str
) -> tuple[np.ndarray, list[str]]:
    """Seconds [N] of each row; the rate given wins over the file's own time."""
    claimed = claims.get("rate", claims.get("fps"))
    if rate is None:
        if not _tells_time(frame):
            said = f"; the file says {float(claimed):g} per second, which is not always the camera's" if claimed else ""
            raise InputError(f"{source}: rate is not given (rows per second){said}: "
                             "rate= (--rate); or, if a column holds seconds, name it: columns={'time': ...} "
                             "(--columns time=NAME)")  # fmt: skip
        return frame["time"].to_numpy(), ["time as the file has it, in seconds"]
    number = check_number(rate, "rate", "rows per second, > 0")
    if number <= 0:
        raise InputError(f"rate: expected rows per second, > 0, got {rate}")
    notes = []
    if claimed and abs(float(claimed) / number - 1) > 0.01:
        notes.append(f"rate {number:g} as given; the file says {float(claimed):g}")
    clock = "frame" if "frame" in frame else "time"
    if clock not in frame:
        return frame.groupby("id", sort=False).cumcount().to_numpy() / number, [*notes, "no clock: every row is a step"]
    ticks = frame[clock].to_numpy()
    if not np.isfinite(ticks).all():
        raise DataError(f"{source}: column {clock!r} has rows without a number")
    step = _tick(frame["id"], ticks)
    if clock == "frame" and step != 1:
        notes.append(f"frames step by {step:g}: {1 / number:g} s from one to the next")
    return ticks / step / number, notes


def _tick(ids: pd.Series, ticks: np.ndarray) -> float:
    """What the clock counts from one row of an individual to the next, most often."""
    order = np.lexsort((ticks, pd.factorize(ids)[0]))
    gaps = np.diff(ticks[order])
    gaps = gaps[(gaps > 0) & (np.diff(pd.factorize(ids)[0][order]) == 0)]
    if not gaps.size:
        return 1.0
    values, counts = np.unique(np.round(gaps, 6), return_counts=True)
    most = float(values[np.argmax(counts)])
    # a clock in seconds jitters: then no gap stands out, and the median is the step
    return most if counts.max() > 0.5 * len(gaps) else float(np.median(gaps))


def validate(frame: Any, source: str = "tracks") -> None:
    """Raise DataError unless ``frame`` is a table of tracks: id, time, x and y, finite."""
    if not isinstance(frame, pd.DataFrame):
        raise DataError(f"{source}: expected a pandas DataFrame of tracks, got {type(frame).__name__}")
    if {"gait", "distance", "angle"} <= set(frame.columns) and "id" not in frame:
        raise DataError(f"{source}: a babbling table of a robot, not tracks; give it to bayeshunt fit")
    for column in ("id", "time", "x", "y"):
        if column not in frame:
            raise DataError(f"{source}: column {column!r} is missing; bayeshunt.read_tracks makes such tables")
        if column == "id":
            continue
        try:
            finite = np.isfinite(frame[column].to_numpy(dtype=float, na_value=np.nan))
        except (TypeError, ValueError):
            raise DataError(f"{source}: column {column!r} holds {frame[column].dtype}; expected numbers") from None
        if not finite.all():
            row = int(np.flatnonzero(~finite)[0])
            raise DataError(f"{source}: row {row}: {column} is {frame[column].iloc[row]}; expected a finite number")
    if frame.empty:
        raise DataError(f"{source}: the table has no rows")


def save(frame: pd.DataFrame, path: str | os.PathLike[str]) -> None:
    """Write tracks as Parquet with what is known of them; the file is replaced atomically."""
    import pyarrow as pa

    check_target(path)
    validate(frame)
    plain = frame.copy(deep=False)
    plain.attrs = {}
    if plain["id"].dtype == object:
        plain["id"] = plain["id"].astype(str)
    table = pa.Table.from_pandas(plain, preserve_index=False).replace_schema_metadata(None)
    parquet.write(table, frame.attrs.get(parquet.PROVENANCE_KEY, {}), path)


def load(path: str | os.PathLike[str]) -> pd.DataFrame:
    """Read tracks written by :func:`save`, or any Parquet with id, time, x, y in SI units; DataError else."""
    table, record = parquet.read(path, what=_EXPECTED, fix=_FIX)
    frame: pd.DataFrame = table.to_pandas()
    validate(frame, os.fspath(path))
    frame.attrs[parquet.PROVENANCE_KEY] = record or {}
    return frame
