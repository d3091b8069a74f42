"""What a prey's next steps depend on: its own speed, and what a simple motion misses. Kept beside the plain counts."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from bayeshunt.core.bins import Axis, EffectAxes
from bayeshunt.core.checks import check_number
from bayeshunt.core.errors import DataError, InputError, did_you_mean, shown
from bayeshunt.core.geometry import FloatArray
from bayeshunt.data.transitions import STANDING_SHARE, motion_frame, window_columns, windows_of
from bayeshunt.models.counting.cells import MAX_DISTANCE_BINS
from bayeshunt.models.target.base_motion import BASES
from bayeshunt.models.target.paths import forward_facing, paths_of
from bayeshunt.models.target.residual_table import ResidualTable
from bayeshunt.models.target.speed_table import OwnSteps, SpeedTable, cell_codes

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Conditions", "ahead_of", "binned", "check_given", "default_axes"]

#: Of futures, the share drawn from whole residuals where both tables are there; the rest step by step. Much of those
#: that go on as they went, little of those that wander (``ResidualTable.wandering`` between these two).
_WHOLE = (0.75, 0.25)
_WANDERING = (0.45, 0.52)


class Conditions:
    """Tables by context; change in place, by addition only.

    time_step: seconds. scale: metres, the typical step of the table that was fitted first. speed: transitions by
    the own speed, or None. residual: whole futures beside a simple motion, or None. by_motion: transitions by speed are
    beside the direction of the last step, not the body's heading.
    """

    def __init__(
        self,
        time_step: float,
        scale: float,
        speed: SpeedTable | None,
        residual: ResidualTable | None,
        by_motion: bool = False,
    ) -> None:
        self.time_step, self.scale, self.speed, self.residual = time_step, scale, speed, residual
        self.by_motion = by_motion

    @classmethod
    def of(
        cls, frame: pd.DataFrame, given: str | None, residual_of: str | None, axes: EffectAxes | None, backoff: float
    ) -> Conditions | None:
        """Return empty conditions for a table of transitions, None if nothing is asked for."""
        if given is None and residual_of is None:
            return None
        for name in ("time_step", "scale"):
            if name not in frame or frame.empty:
                raise DataError(
                    f"transitions: column {name!r} is missing; make them with bayeshunt.transitions(tracks)"
                )
        step, scale = _only(frame, "time_step"), float(frame["scale"].max())
        grid = axes if axes is not None else default_axes(frame, fine=given is not None)
        seen, steps = windows_of(frame.columns)
        if residual_of is not None and (seen < 3 or steps < 1):
            raise DataError(
                "transitions: residuals need past and future: bayeshunt.transitions(tracks, seen=8, steps=12)"
            )
        speed = None if given is None else SpeedTable(grid, backoff)
        residual = None if residual_of is None else ResidualTable(residual_of, seen, steps, scale, backoff)
        by_motion = bool("by_motion" in frame and frame["by_motion"].iloc[0] and seen > 1)
        return cls(step, scale, speed, residual, by_motion)

    def codes(self, frame: pd.DataFrame) -> np.ndarray:
        """Return the cell number [N] of each transition in the frame that the table by speed counts it in."""
        assert self.speed is not None
        distance = frame["distance"].to_numpy(dtype=float)
        if self.by_motion:
            return cell_codes(self.speed.axes, distance, *motion_frame(frame, STANDING_SHARE * self.scale))
        return cell_codes(self.speed.axes, distance, *(frame[n].to_numpy(dtype=float) for n in ("angle", "heading")))

    def kinds(self, frame: pd.DataFrame) -> np.ndarray:
        """Return the class [N] of the step before each transition in the table by speed; any where it is not known."""
        assert self.speed is not None
        before = frame["speed"].to_numpy(dtype=float) * self.time_step
        names = window_columns(windows_of(frame.columns)[0], 0)
        past = frame[names].to_numpy(dtype=float).reshape(len(frame), -1, 2)
        earlier = np.hypot(*np.moveaxis(np.diff(past, axis=1), 2, 0))[:, ::-1]
        steps = np.column_stack([earlier, before])
        return self.speed.classes(np.nan_to_num(before), self.speed.stood(steps))

    @property
    def is_empty(self) -> bool:
        """True while neither table has counted anything."""
        return not ((self.speed and self.speed.counts) or (self.residual and self.residual.counts))

    def update(self, frame: pd.DataFrame) -> None:
        """Count a table of transitions of the same time-step; DataError for another."""
        if frame.empty:
            return
        if abs(_only(frame, "time_step") / self.time_step - 1) > 1e-6:
            raise DataError(
                f"transitions: time_step is {_only(frame, 'time_step'):g} s; this model's is {self.time_step:g} s"
            )
        if self.speed is not None:
            told = np.isfinite(frame["speed"].to_numpy(dtype=float))
            self.speed.add(self.kinds(frame)[told], self.codes(frame)[told])
        if self.residual is not None:
            paths = paths_of(frame, self.residual.seen, self.residual.steps)
            self.residual.add(forward_facing(paths, self.residual.seen, self.scale)[0])

    def futures(
        self, seen: FloatArray, steps: int, n: int, *, rng: np.random.Generator, headings: FloatArray | None,
        made_up: int = 0,
    ) -> FloatArray:  # fmt: skip
        """Return complex [N, n, steps] places that may follow ``seen`` [N, T]; see ``PreyModel.futures``.

        made_up: how many of the first places were not seen, so that steps from there are not the prey's own.
        """
        turned, direction = forward_facing(seen, seen.shape[1], self.scale, headings)
        whole = 0
        residual = self.residual
        if residual is not None and residual.counts and steps <= residual.steps and seen.shape[1] >= residual.seen:
            whole = n if self.speed is None else round(float(np.interp(residual.wandering, _WANDERING, _WHOLE)) * n)
        out = np.empty((len(seen), n, steps), dtype=complex)
        from_speed = _evenly(n, n - whole)  # any part of the draws holds both in their shares
        if whole and residual is not None:
            drawn = residual.draw(turned[:, -residual.seen :], whole, steps, rng=rng)
            out[:, ~from_speed] = drawn * direction[:, None, None]
        if whole < n:
            facing = direction
            if headings is not None and not self.by_motion:
                facing = np.where(np.isfinite(headings), np.exp(1j * headings), direction)
            ahead = self._stepwise(turned[:, made_up:], n - whole, steps, rng)
            out[:, from_speed] = ahead * facing[:, None, None]
        return out + seen[:, -1][:, None, None]

    def _stepwise(self, seen: FloatArray, n: int, steps: int, rng: np.random.Generator) -> FloatArray:
        """Complex [N, n, steps] drawn step by step after the places ``seen`` [N, T], the last at 0, facing forward."""
        table = self.speed
        if table is None:
            raise InputError("this model has no transitions by speed: fit it with given='speed' for as many steps")
        own = OwnSteps(seen, table, STANDING_SHARE * self.scale)
        before, which = np.abs(np.diff(seen, axis=1)), np.repeat(np.arange(len(seen)), n)
        speed, stood = before[which, -1], table.stood(before)[which]
        place, facing = np.zeros(len(speed), dtype=complex), np.ones(len(speed), dtype=complex)
        out = np.empty((len(place), steps), dtype=complex)
        for step in range(steps):
            kinds = table.classes(speed, stood)
            speed, angle, heading = own.instead(which, kinds, table.draw(kinds, rng=rng), rng=rng)
            stood = np.where(table.stood(speed[:, None]) > 0, stood + 1, 0)
            place = place + speed * np.exp(-1j * angle) * facing
            facing = facing * np.exp(-1j * heading)
            out[:, step] = place
        return out.reshape(len(seen), n, steps)

    def merge(self, other: Conditions) -> None:
        """Count what ``other`` has counted; InputError if it was counted otherwise."""
        if self._kind() != other._kind():
            raise InputError("cannot join prey models with different conditions")
        if self.speed is not None and other.speed is not None:
            self.speed.merge(other.speed)
        if self.residual is not None and other.residual is not None:
            self.residual.merge(other.residual)

    def copy(self) -> Conditions:
        """Return independent tables with the same counts."""
        return copy.deepcopy(self)

    def _kind(self) -> tuple[Any, ...]:
        speed = None if self.speed is None else (self.speed.axes, self.speed.backoff)
        residual = self.residual
        whole = None if residual is None else (residual.base, residual.seen, residual.steps, residual.backoff)
        return self.time_step, self.scale, speed, whole, self.by_motion

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Conditions):
            return NotImplemented
        mine, theirs = (
            (c.speed and c.speed.counts, c.residual and (c.residual.counts, c.residual.kept)) for c in (self, other)
        )
        return self._kind() == other._kind() and mine == theirs

    __hash__ = None  # type: ignore[assignment]  # mutable

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers for JSON."""
        speed = None if self.speed is None else self.speed.to_dict()
        residual = None if self.residual is None else self.residual.to_dict()
        return {"time_step": self.time_step, "scale": self.scale, "speed": speed, "residual": residual,
                "by_motion": self.by_motion}  # fmt: skip

    @classmethod
    def from_dict(cls, record: dict[str, Any], axes: EffectAxes) -> Conditions:
        """Rebuild from :meth:`to_dict`; KeyError, TypeError or ValueError if it is none."""
        speed = None if record["speed"] is None else SpeedTable.from_dict(record["speed"], axes)
        residual = None if record["residual"] is None else ResidualTable.from_dict(record["residual"])
        by_motion = record.get("by_motion", False)  # files of before do not say
        if not isinstance(by_motion, bool):
            raise TypeError("by_motion")
        return cls(float(record["time_step"]), float(record["scale"]), speed, residual, by_motion)


def _only(frame: pd.DataFrame, column: str) -> float:
    values = frame[column].unique()
    if len(values) != 1:
        raise DataError(f"transitions: column {column!r} holds {len(values)} values; a model has one")
    return float(values[0])


def _evenly(n: int, some: int) -> np.ndarray:
    """Flags [n] of which ``some`` are set, spread evenly."""
    marks = (np.arange(1, n + 1) * some) // n
    return np.diff(marks, prepend=0) > 0


def ahead_of(seen: FloatArray, ahead: FloatArray, headings: FloatArray | None) -> FloatArray:
    """Return own-frame places ``ahead`` [N, n, S] (forward + i left) at the end of ``seen`` [N, T], in its frame."""
    last = seen[:, -1] - seen[:, -2] if seen.shape[1] > 1 else np.ones(len(seen))
    facing = np.where(np.abs(last) > 0, last / np.where(np.abs(last) > 0, np.abs(last), 1.0), 1.0)
    if headings is not None:
        facing = np.where(np.isfinite(headings), np.exp(1j * headings), facing)
    return np.asarray(seen[:, -1][:, None, None] + ahead * facing[:, None, None])


def default_axes(frame: pd.DataFrame, *, fine: bool) -> EffectAxes:
    """Return bins for a table of transitions: a twentieth of its typical step and 120 turns, or a tenth and 36."""
    if "scale" not in frame or frame.empty:
        raise DataError(
            "transitions: column 'scale' is missing; give axes, or make them with bayeshunt.transitions(tracks)"
        )
    scale, turns = float(frame["scale"].max()), 120 if fine else 36
    width = scale / (20 if fine else 10)
    return EffectAxes(Axis.linear("Distance", width), Axis.full_turn("Angle", turns), Axis.full_turn("Heading", turns))


def binned(frame: pd.DataFrame, axes: EffectAxes) -> Iterator[tuple[tuple[int, int, int], int]]:
    """Yield each (Distance, Angle, Heading) cell of a table of transitions and how many rows fall into it."""
    distance = frame["distance"].to_numpy(dtype=float)
    if len(distance) and distance.max() >= MAX_DISTANCE_BINS * axes.distance.width:
        row = int(np.argmax(distance))
        raise DataError(
            f"transitions: row {row}: distance is {distance[row]:g}; the distance grid does not reach that far"
        )
    codes = cell_codes(axes, distance, frame["angle"].to_numpy(dtype=float), frame["heading"].to_numpy(dtype=float))
    turns = axes.heading.bins
    for code, count in zip(*(a.tolist() for a in np.unique(codes, return_counts=True)), strict=True):
        yield (code // (axes.angle.bins * turns), code // turns % axes.angle.bins, code % turns), count


def check_given(given: Any, residual_of: Any, backoff: Any) -> None:
    """Raise InputError for an unknown context, an unknown motion or a weight that is none."""
    if check_number(backoff, "backoff", "a weight > 0") <= 0:
        raise InputError(f"backoff: expected a weight > 0, got {backoff}")
    if given not in (None, "speed"):
        raise InputError(f"given: expected 'speed' or None, got {shown(given)}")
    if residual_of is not None and (not isinstance(residual_of, str) or residual_of not in BASES):
        raise InputError(
            f"residual_of: unknown motion {shown(residual_of)}{did_you_mean(str(residual_of), list(BASES))}"
        )
