"""What earlier runs taught about the prey: transition tables, kept by context, and how much to believe them.

A context is nothing (one table for all), the prey's place in the arena (a cell and the direction it
faces), or its previous transition (order 1). Letters: n counts of a transition's cell, N their sum, K
the number of cells of the grid, s the smoothing in transitions.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.geometry import Polar, Pose, wrap
from bayeshunt.files.atomic import write_text
from bayeshunt.files.endings import check_ending
from bayeshunt.files.records import RecordKind, digest

__all__ = ["FORMAT", "KINDS", "Cell", "Context", "PreyMemory", "TransitionTables"]

FORMAT = 1
#: How a table may be conditioned.
KINDS = ("all", "place", "previous")
#: Bins of a distance [m], an angle and a heading: where a transition falls.
Cell = tuple[int, int, int]
#: What a table is conditioned on: () for all, cell and direction for place, coarse transition for previous.
Context = tuple[int, ...]

_RECORD = RecordKind("prey memory", "bayeshunt remember", (FORMAT,))
_DIRECTIONS = 8  # of a place, and of the turn in a previous transition
_DISTANCE_BINS = 100  # of the grid that smoothing spreads over


@dataclass
class TransitionTables:
    """Counts of prey transitions by context; mutable: :meth:`observe` adds one.

    kind: one of :data:`KINDS`. axes: the bins of a transition. place_size: side of a place, metres.
    """

    kind: str
    axes: EffectAxes
    place_size: float
    counts: dict[Context, dict[Cell, int]] = field(default_factory=dict)

    def context(self, place: Pose | None, previous: Polar | None) -> Context | None:
        """Return the context of the next transition; None if it is not known.

        place: the prey's pose in the frame that the hunter started in. previous: its last transition.
        """
        if self.kind == "all":
            return ()
        if self.kind == "place":
            if place is None:
                return None
            direction = round(float(place.theta) / (2 * math.pi) * _DIRECTIONS) % _DIRECTIONS
            return math.floor(place.x / self.place_size), math.floor(place.y / self.place_size), direction
        if previous is None:
            return None
        turn = round(float(wrap(float(previous.heading))) / (2 * math.pi) * _DIRECTIONS) % _DIRECTIONS
        return turn, min(int(previous.distance / (5 * self.axes.distance.width)), 9)

    def cell(self, transition: Polar) -> Cell:
        """Return the cell of a transition."""
        distance, angle, heading = (float(part) for part in transition)
        axes = self.axes
        return int(axes.distance.index(distance)), int(axes.angle.index(angle)), int(axes.heading.index(heading))

    def observe(self, context: Context, transition: Polar) -> None:
        """Count one transition under a context."""
        table = self.counts.setdefault(context, {})
        cell = self.cell(transition)
        table[cell] = table.get(cell, 0) + 1

    def total(self, context: Context | None) -> int:
        """Return N, the transitions seen under a context; 0 for None."""
        return 0 if context is None else sum(self.counts.get(context, {}).values())

    def probability(self, context: Context | None, transition: Polar, base: float, smoothing: float) -> float:
        """Return ``(n + s base) / (N + s)``: the predictive probability of a transition's cell.

        base: what a coarser table says of the cell (or 1 / K, see :meth:`uniform`).
        """
        table = {} if context is None else self.counts.get(context, {})
        seen, total = table.get(self.cell(transition), 0), sum(table.values())
        return (seen + smoothing * base) / (total + smoothing)

    @property
    def uniform(self) -> float:
        """1 / K: a cell's probability before anything is known."""
        return 1.0 / (_DISTANCE_BINS * self.axes.angle.bins * self.axes.heading.bins)

    def centre(self, cell: Cell) -> tuple[float, float, float]:
        """Return the metres ahead and to the right and the turn [rad clockwise] of a cell's centre."""
        axes = self.axes
        distance = (cell[0] + 0.5) * axes.distance.width
        angle = float(axes.angle.centres[cell[1]])
        return distance * math.cos(angle), distance * math.sin(angle), float(axes.heading.centres[cell[2]])

    def cpt(self, context: Context = ()) -> pd.DataFrame:
        """Return the table under a context: distance [m], angle, heading [rad], count, probability; cells seen only."""
        table = self.counts.get(context, {})
        total = sum(table.values())
        rows = [
            (
                (cell[0] + 0.5) * self.axes.distance.width,
                float(self.axes.angle.centres[cell[1]]),
                float(self.axes.heading.centres[cell[2]]),
                count,
                count / total,
            )
            for cell, count in sorted(table.items())
        ]
        return pd.DataFrame(rows, columns=["distance", "angle", "heading", "count", "probability"])


@dataclass(frozen=True)
class PreyMemory:
    """The tables of earlier runs, by where they were made and by kind of context.

    tables: arena -> kind -> tables. provenance: settings, arenas, runs and seed of the training hunts.
    """

    tables: Mapping[str, Mapping[str, TransitionTables]]
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def empty(
        cls, arenas: Sequence[str], axes: EffectAxes, place_size: float, provenance: Mapping[str, Any] | None = None
    ) -> PreyMemory:
        """Return a memory that has seen nothing; ``place_size`` in metres."""
        tables = {a: {kind: TransitionTables(kind, axes, place_size) for kind in KINDS} for a in arenas}
        return cls(tables, provenance or {})

    def observe_track(self, arena: str, places: Sequence[Pose], transitions: Sequence[Polar]) -> None:
        """Count one run: the prey's pose before each transition, and the transitions, in order."""
        for number, (place, transition) in enumerate(zip(places, transitions, strict=True)):
            previous = transitions[number - 1] if number else None
            for tables in self.tables[arena].values():
                context = tables.context(place, previous)
                if context is not None:
                    tables.observe(context, transition)

    @property
    def observations(self) -> int:
        """Transitions seen."""
        return sum(kinds["all"].total(()) for kinds in self.tables.values())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the memory as JSON with a checksum, replaced atomically."""
        check_ending(path, "memories", ".json")
        body = self._record()
        write_text(path, json.dumps({"checksum": digest(body), "memory": body}) + "\n")

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> PreyMemory:
        """Read a memory; ModelFileError in one line if the file is missing, damaged or something else."""
        text, name = _RECORD.read_text(path), os.fspath(path)
        outer = _RECORD.parse(text, name)
        body = outer.get("memory")
        # The first record files of this project: without a kind, the format inside the content.
        if not isinstance(body, dict):
            raise _RECORD.stranger(name, ", or damaged")
        _RECORD.check_version(body.get("format"), name)
        _RECORD.check_sum(outer.get("checksum"), digest(body), name)
        try:
            return cls._from_record(outer["memory"])
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise _RECORD.malformed(name, error) from None

    def _record(self) -> dict[str, Any]:
        some = next(iter(self.tables.values()))["all"]
        return {
            "format": FORMAT,
            "distance_width": some.axes.distance.width,
            "angle_bins": some.axes.angle.bins,
            "heading_bins": some.axes.heading.bins,
            "place_size": some.place_size,
            "tables": {a: {kind: _rows(t.counts) for kind, t in kinds.items()} for a, kinds in self.tables.items()},
            "provenance": dict(self.provenance),
        }

    @classmethod
    def _from_record(cls, body: dict[str, Any]) -> PreyMemory:
        axes = EffectAxes.standard(
            body["distance_width"], distance_bin=1.0, angle_bins=body["angle_bins"], heading_bins=body["heading_bins"]
        )
        memory = cls.empty(list(body["tables"]), axes, body["place_size"], body["provenance"])
        for arena, kinds in body["tables"].items():
            for kind, rows in kinds.items():
                counts = memory.tables[arena][kind].counts
                counts.update({tuple(context): {(d, a, h): n for d, a, h, n in cells} for context, cells in rows})
        return memory


def _rows(counts: dict[Context, dict[Cell, int]]) -> list[Any]:
    """Counts as lists, in order: [context, [[distance, angle, heading, count], ...]]."""
    return [[list(c), [[*cell, n] for cell, n in sorted(table.items())]] for c, table in sorted(counts.items())]
