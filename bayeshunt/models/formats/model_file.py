"""The model file: JSON that anyone can open, checksummed, written all or nothing.

``content`` holds what defines a model (gaits, axes, counts, fixed-point sums, prior, provenance);
every probability is derived from it. Keys are sorted and numbers written in full, so that the same
model gives the same bytes and comes back bit for bit.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from bayeshunt.core.bins import EFFECTS, ENERGY, Axis, EffectAxes
from bayeshunt.core.checks import check_pseudo_count
from bayeshunt.core.errors import BayesHuntError, InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.files.atomic import replace_atomically
from bayeshunt.files.endings import check_ending
from bayeshunt.files.records import RecordKind
from bayeshunt.files.records import checksum as _checksum
from bayeshunt.models.counting.cells import MAX_DISTANCE_BINS
from bayeshunt.models.counting.energy import nothing
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.previous import PreviousCounts
from bayeshunt.models.motion.residuals import UNICYCLE, Residuals
from bayeshunt.models.motion.unicycle import Unicycle
from bayeshunt.models.tables.counted import ContextTables, CountedTables, tables_of
from bayeshunt.models.tables.drawn import DrawnTables
from bayeshunt.models.tables.residual import ResidualTables
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import NAIVE, PREVIOUS, PREVIOUS_GAIT, Structure, depends_on_previous

__all__ = ["FORMAT", "KIND", "MAKER", "READABLE", "Storable", "Stored", "dumps", "load", "loads", "save"]

#: What the file says it is.
KIND = "bayeshunt forward model"
#: The command that makes one.
MAKER = "bayeshunt fit babbling.parquet"
#: Newest version of the layout of ``content``: the motion whose residuals it counts lags behind its commands.
FORMAT = 7
#: Energy is a node, whose bins and counts it holds.
_FORMAT_WITH_ENERGY = 6
#: Tables of what a motion misses, with the motion and the poses' counts.
_FORMAT_WITH_RESIDUALS = 5
#: Tables with back-off, whose strength it holds.
_FORMAT_WITH_BACKOFF = 4
#: What a model that depends on the gait before is written in, without back-off.
_FORMAT_WITH_PREVIOUS = 3
#: What a model that does not depend on the gait before is written in, so that older programs can read it.
_FORMAT_WITHOUT_PREVIOUS = 2
#: Layouts that can be read: format 1 had no "structure" and held the paper's.
READABLE = (1, 2, 3, 4, 5, 6, 7)

_RECORD = RecordKind(KIND, MAKER, READABLE)


class Storable(Protocol):
    """What can be written; a forward model is one."""

    @property
    def source(self) -> TableSource:
        """Its tables."""

    @property
    def provenance(self) -> Mapping[str, Any]:
        """Where the rows came from."""


class Stored(NamedTuple):
    """What a model file holds: the counted tables, and where their rows came from."""

    source: CountedTables | ContextTables | ResidualTables
    provenance: Mapping[str, Any]


def save(model: Storable, path: str | os.PathLike[str]) -> None:
    """Write ``model``; the file is read back and compared before it takes its name.

    Raises BayesHuntError if the folder cannot be written or the provenance is not JSON.
    """
    check_ending(path, "models", ".json")
    text = dumps(model)
    with replace_atomically(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
        if load(temporary).source != model.source:
            raise BayesHuntError(f"{os.fspath(path)}: the model did not come back as it was written")


def load(path: str | os.PathLike[str]) -> Stored:
    """Read a model file.

    Raises ModelFileError in one line: missing, unreadable, not JSON, another kind of file, a newer
    format, edited (checksum), or malformed.
    """
    return loads(_RECORD.read_text(path), os.fspath(path))


def dumps(model: Storable) -> str:
    """Return the text of the model file: deterministic, one counted cell per line.

    Raises InputError for an imported network, which has no counts to hold.
    """
    if isinstance(model.source, DrawnTables):
        raise InputError("these are the ordinary tables of a model of residuals; save that model itself")
    if not isinstance(model.source, (CountedTables, ContextTables, ResidualTables)):
        raise InputError("an imported network has no counts, which a model file needs; export it: to_xmlbif")
    content = _content(model.source, model.provenance)
    facts = {"kind": KIND, "format": _version(model.source), "checksum": _checksum(content)}
    head = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in facts.items()]
    body = [f" {json.dumps(key)}: {_layout(key, content[key])}" for key in sorted(content)]
    return "{\n" + ",\n".join(head) + ',\n"content": {\n' + ",\n".join(body) + "\n}}\n"


def loads(text: str, name: str = "model") -> Stored:
    """Return the model in ``text``; ``name`` is what errors call it. Raises ModelFileError."""
    version, content = _RECORD.loads(text, name)
    try:
        return _model(content, NAIVE if version == 1 else _structure(content["structure"]))
    except (KeyError, TypeError, ValueError, OverflowError, BayesHuntError) as error:
        raise _RECORD.malformed(name, error) from None


def _version(tables: CountedTables | ContextTables | ResidualTables) -> int:
    """The oldest format that can say everything, so that older programs can read the file."""
    if isinstance(tables, ResidualTables) and tables.residuals.motion.lags:
        return FORMAT
    if tables.axes.energy is not None:
        return _FORMAT_WITH_ENERGY
    if isinstance(tables, ResidualTables):
        return _FORMAT_WITH_RESIDUALS
    if tables.backoff is not None:
        return _FORMAT_WITH_BACKOFF
    return _FORMAT_WITH_PREVIOUS if isinstance(tables, ContextTables) else _FORMAT_WITHOUT_PREVIOUS


# --- a model as plain numbers ----------------------------------------------------------------------


def _content(tables: CountedTables | ContextTables | ResidualTables, provenance: Mapping[str, Any]) -> dict[str, Any]:
    gaits = tables.gaits
    leaning = {} if tables.backoff is None else {"backoff": tables.backoff}
    motion = _residual_record(tables) if isinstance(tables, ResidualTables) else {}
    return {
        **leaning,
        **motion,
        **_counts_record(tables.counted),
        "body_length": gaits.body_length,
        "duration": gaits.duration,
        "gait_prior": tables.gait_prior,
        "gaits": [{"name": gait.name, "command": list(gait.command)} for gait in gaits],
        "prior": tables.prior,
        "provenance": _plain(dict(provenance)),
        "structure": {"name": tables.structure.name, "edges": [list(edge) for edge in tables.structure.edges]},
    }


def _counts_record(counts: JointCounts | PreviousCounts) -> dict[str, Any]:
    """Bins, counted cells and fixed-point sums."""
    table = counts.table
    sums = _sums_by_previous(counts) if isinstance(counts, PreviousCounts) else counts.sums
    energy = (counts.joint if isinstance(counts, PreviousCounts) else counts).energy
    return {
        **({"energy": energy.tolist()} if energy.size else {}),
        **({"energy_counts": _spent(counts)} if counts.axes.energy is not None else {}),
        "axes": {axis.name: _axis_record(axis) for axis in counts.axes.all},
        "cells": np.column_stack([table.cells, table.counts]).tolist(),
        "cells_columns": [*table.names, "count"],
        "pose_sums": sums.tolist(),
    }


def _spent(counts: JointCounts | PreviousCounts) -> list[Any]:
    """Rows by bin of Energy and gait [E, G]; one such table for each gait before, where that is counted."""
    parts = counts.after if isinstance(counts, PreviousCounts) else (counts,)
    made = [part.spent.tolist() for part in parts]
    return made if isinstance(counts, PreviousCounts) else list(made[0])


def _residual_record(tables: ResidualTables) -> dict[str, Any]:
    """The motion whose residuals are counted, the bins they were given, and the counts of the poses themselves."""
    motion, axes = tables.residuals.motion, tables.residuals.axes
    return {
        "residual_of": {
            "motion": UNICYCLE, "forward": list(motion.forward), "left": list(motion.left),
            **({"lag": list(motion.lag)} if motion.lags else {}),
            "axes": {axis.name: _axis_record(axis) for axis in axes},
        },
        "outcomes": _counts_record(tables.seen),
    }  # fmt: skip


def _sums_by_previous(counts: PreviousCounts) -> np.ndarray:
    """Pose sums [G, G, P + 1, 4] by the gait before; 0 where nothing was counted."""
    shape = max(part.sums.shape for part in counts.after)
    return np.stack([part.sums if part.total else np.zeros(shape, dtype=np.int64) for part in counts.after])


def _axis_record(axis: Axis) -> dict[str, Any]:
    return {
        "width": axis.width, "bins": axis.bins, "circular": axis.circular, "labels": list(axis.labels)
    }  # fmt: skip


def _plain(provenance: dict[str, Any]) -> Any:
    try:
        return json.loads(json.dumps(provenance, allow_nan=False))
    except (TypeError, ValueError) as error:
        raise BayesHuntError(f"the model's provenance cannot be stored as JSON: {error}") from None


def _layout(key: str, value: Any) -> str:
    if key in ("cells", "gaits", "pose_sums", "energy"):
        rows = ",\n  ".join(json.dumps(row, sort_keys=True) for row in value)
        return f"[\n  {rows}]"
    return json.dumps(value, sort_keys=True)


# --- plain numbers as a model ----------------------------------------------------------------------


def _model(content: Any, structure: Structure) -> Stored:
    gaits = GaitRepertoire(
        tuple(Gait(str(g["name"]), tuple(float(v) for v in g["command"])) for g in content["gaits"]),
        body_length=_measure(content["body_length"]),
        duration=_measure(content["duration"]),
    )
    # None would be taken for a default, and a file says what it was fitted with
    prior = check_pseudo_count(content["prior"], "prior")
    gait_prior, provenance = content["gait_prior"], dict(content["provenance"])
    if depends_on_previous(structure) and structure.poses != PREVIOUS_GAIT:
        raise ValueError(f"structure {structure.name!r} has {PREVIOUS} among its causes")
    counts = _counts(content, structure, gaits)
    tables = tables_of(counts, prior, gait_prior, structure, content.get("backoff"))
    if "residual_of" not in content:
        return Stored(tables, provenance)
    return Stored(ResidualTables(tables, _residuals(content["residual_of"], gaits),
                                 _counts(content["outcomes"], structure, gaits)), provenance)  # fmt: skip


def _counts(content: Any, structure: Structure, gaits: GaitRepertoire) -> JointCounts | PreviousCounts:
    """The counts of bins, cells and sums, of the kind that the structure needs."""
    axes, rows = _axes(content["axes"]), _whole(content["cells"], 2)
    if depends_on_previous(structure):
        sums = _whole(content["pose_sums"], 4)
        spent = _energy_counts(content, 3, (len(gaits), *_bins_of_energy(axes), len(gaits)))
        return _previous_counts(rows.reshape(-1, 6), sums, gaits, axes, _energy(content, gaits), spent)
    joint = _joint_counts(rows.reshape(-1, 5), _whole(content["pose_sums"], 3), gaits, axes)
    if axes.energy is None:
        return replace(joint, energy=_energy(content, gaits))
    spent = _energy_counts(content, 2, (*_bins_of_energy(axes), len(gaits)))
    return replace(joint, energy=_energy(content, gaits), spent=spent)


def _bins_of_energy(axes: EffectAxes) -> tuple[int, ...]:
    return () if axes.energy is None else (axes.energy.bins,)


def _energy_counts(content: Any, dimensions: int, shape: tuple[int, ...]) -> np.ndarray:
    """The counts behind the table of Energy; nothing in files where it is no node."""
    if len(shape) < dimensions:
        return np.zeros(0, dtype=np.int64)
    counts = _whole(content["energy_counts"], dimensions)
    if counts.shape != shape or counts.min() < 0:
        raise ValueError(f"energy_counts has shape {counts.shape}")
    return counts


def _residuals(record: Any, gaits: GaitRepertoire) -> Residuals:
    if record["motion"] != UNICYCLE:
        raise ValueError(f"residual_of: unknown motion {record['motion']!r}")
    speed, turn = (float(v) for v in record.get("lag", (0.0, 0.0)))
    if not (speed >= 0 and turn >= 0):
        raise ValueError(f"residual_of: the lag is {record['lag']}")
    forward, left = (tuple(float(v) for v in record[name]) for name in ("forward", "left"))
    motion = Unicycle(forward, left, (speed, turn))
    if {len(gait.command) for gait in gaits} != {len(motion.forward)} or len(motion.left) != len(motion.forward):
        raise ValueError("residual_of: the motion has other actuators than the gaits")
    return Residuals(motion, gaits, _axes(record["axes"]))


def _axes(record: Any) -> EffectAxes:
    energy = _axis(ENERGY, record[ENERGY]) if ENERGY in record else None
    return EffectAxes(*(_axis(name, record[name]) for name in EFFECTS), energy=energy)


def _measure(value: Any) -> float | None:
    return None if value is None else float(value)


def _joint_counts(rows: np.ndarray, sums: np.ndarray, gaits: GaitRepertoire, axes: EffectAxes) -> JointCounts:
    """Counts from rows [K, 5] of (Gait, Distance, Angle, Heading, count) and pose sums [G, P + 1, 4]."""
    _check_rows(rows, (len(gaits), *axes.shape))
    if sums.shape[0] != len(gaits) or sums.shape[2] != 4:
        raise ValueError(f"pose_sums has shape {sums.shape}")
    return JointCounts(gaits, axes, rows[:, :4], rows[:, 4], sums)


def _energy(content: Any, gaits: GaitRepertoire) -> np.ndarray:
    """The tally of energy [G + 1, G, 3]; nothing in files of rows that did not say it."""
    if "energy" not in content:
        return nothing()
    tally = _whole(content["energy"], 3)
    if tally.shape != (len(gaits) + 1, len(gaits), 3):
        raise ValueError(f"energy has shape {tally.shape}")
    return tally


def _previous_counts(
    rows: np.ndarray, sums: np.ndarray, gaits: GaitRepertoire, axes: EffectAxes, energy: np.ndarray,
    spent: np.ndarray,
) -> PreviousCounts:  # fmt: skip
    """Counts from rows [K, 6], PreviousGait first, pose sums [G, G, P + 1, 4], the tally of energy and its
    counts [G, E, G]."""
    _check_rows(rows, (len(gaits), len(gaits), *axes.shape))
    if sums.shape[:2] != (len(gaits), len(gaits)):
        raise ValueError(f"pose_sums has shape {sums.shape}")
    after = []
    for before in range(len(gaits)):
        part = rows[rows[:, 0] == before, 1:]
        one = _joint_counts(part, sums[before], gaits, axes) if len(part) else JointCounts.empty(gaits, axes)
        if energy.size and len(part):
            own = np.zeros_like(energy)
            own[before] = energy[before]
            one = replace(one, energy=own)
        if spent.size:
            one = replace(one, spent=spent[before])
        after.append(one)
    return PreviousCounts(tuple(after))


def _structure(record: dict[str, Any]) -> Structure:
    return Structure(record["name"], tuple((parent, child) for parent, child in record["edges"]))


def _axis(name: str, record: dict[str, Any]) -> Axis:
    bins, circular = record["bins"], record["circular"]
    if not _is_whole(bins) or bins > MAX_DISTANCE_BINS or circular is not (name not in ("Distance", ENERGY)):
        raise ValueError(f"axis {name}: {bins!r} bins, circular {circular!r}")
    axis = Axis(name, float(record["width"]), bins, circular)
    if record["labels"] != list(axis.labels):
        raise ValueError(f"axis {name}: labels do not fit its bins")
    return axis


def _check_rows(rows: np.ndarray, shape: tuple[int, ...]) -> None:
    cells = rows[:, :-1]
    if np.any(cells < 0) or np.any(cells >= np.array(shape)) or np.any(rows[:, -1] < 1):
        raise ValueError("a counted cell lies outside the table or has no count")
    if np.any(np.diff(np.ravel_multi_index(tuple(cells.T), shape)) <= 0):
        raise ValueError("counted cells must be sorted and unique")


def _whole(value: Any, dimensions: int) -> np.ndarray:
    array = np.array(value)
    if array.size and (array.dtype != np.int64 or array.ndim != dimensions):
        raise ValueError(f"expected whole numbers in {dimensions} dimensions")
    return array.astype(np.int64)


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)
