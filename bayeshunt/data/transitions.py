"""From tracks to transitions: where an individual is one time-step later, in its own frame one time-step earlier.

Columns: ``scene``, ``id``, ``time`` [s] of the present; ``distance`` [m], ``angle`` and ``heading`` [rad clockwise] of
the transition; ``speed`` [m/s] of the step before (NaN where it is not known); ``time_step`` [s]; ``scale`` [m], the
median step of those that move, the unit of the models' default bins; ``by_motion``, whether the last step tells better
than the body's heading where it goes next (of all rows together); ``past_NN_forward``, ``past_NN_right`` [m], where it
was NN steps ago, and ``future_NN_forward``, ``future_NN_right`` [m], where it is NN steps later, all in the frame of
the present; NaN where the run does not reach. In tracks that are not in metres, lengths are in their unit.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import FULL_TURN, beyond_a_turn, check_number, check_whole
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.geometry import wrap

if TYPE_CHECKING:  # readers and pandas come when a table does: who hunts needs neither
    import pandas as pd

    from bayeshunt.data.steps import Run

__all__ = [
    "STANDING_SHARE",
    "facing",
    "motion_frame",
    "transitions",
    "validate_transitions",
    "window_columns",
    "windows_of",
]

#: Slower than this share of the median step is standing, unless the caller says otherwise.
STANDING_SHARE = 0.1
#: The last step must tell the next direction better than the body by this much.
_CLEARLY = 0.85
_WINDOW = re.compile(r"(past|future)_(\d+)_forward$")


@checked
def transitions(
    tracks: pd.DataFrame,
    time_step: float | None = None,
    standing: float | None = None,
    *,
    seen: int = 8,
    steps: int = 12,
) -> pd.DataFrame:
    """Return the own-frame transitions of ``tracks``, from every sample that has a direction.

    time_step: seconds of one transition; by default the time between rows. With a longer one rows overlap:
        every sample starts one, so that rows depend on each other.
    standing: speed [m/s] below which an individual stands: it then keeps the direction that it had. By default
        a tenth of the median step of those that move. Where the file has the body's heading, that is taken.
    seen: places known, the present one included: seen - 1 columns of the past; steps: columns of the future.

    Raises DataError if ``tracks`` is none or no run is long enough.
    """
    import pandas as pd

    from bayeshunt.data.steps import median_step, native_step, runs

    check_whole(seen, "seen", 2)
    check_whole(steps, "steps", 0)
    found = runs(tracks, time_step)
    scale = median_step(found)
    step = native_step(tracks) if time_step is None else float(time_step)
    if standing is not None and check_number(standing, "standing", "a speed >= 0") < 0:
        raise InputError(f"standing: expected a speed >= 0, got {standing}")
    least = STANDING_SHARE * scale if standing is None else float(standing) * step
    parts = [part for run in found if (part := _of_run(run, step, least, seen, steps)) is not None]
    if not parts:
        raise DataError("tracks: nobody moves for two time-steps on end; give a shorter time_step")
    table = pd.concat(parts, ignore_index=True).assign(time_step=step, scale=scale)
    return table.assign(by_motion=bool(any(np.isfinite(r.headings).any() for r in found) and _motion_tells(table)))


def motion_frame(table: pd.DataFrame, least: float) -> tuple[np.ndarray, np.ndarray]:
    """Return angle and heading [N] (rad clockwise) of each transition beside the direction of the last step.

    least: a step no longer than this has no direction; the last one that had one counts, without any the body's own.
    The heading of a transition is then the direction that it goes in; one that stands keeps its own.
    """
    seen = windows_of(table.columns)[0]
    names = window_columns(seen, 0)
    past = table[names].to_numpy(dtype=float).reshape(len(table), -1, 2)
    places = np.concatenate([np.zeros((len(table), 1)), past[..., 0] + 1j * past[..., 1]], axis=1)
    steps = places[:, :-1] - places[:, 1:]  # the nearest first
    moved = np.abs(steps) > least  # False where nothing is known
    ever, chosen = moved.any(axis=1), steps[np.arange(len(table)), np.argmax(moved, axis=1)]
    before = np.where(ever, np.angle(np.where(ever, chosen, 1.0)), 0.0)
    angle = np.asarray(wrap(table["angle"].to_numpy(dtype=float) - before))
    return angle, np.where(table["distance"].to_numpy(dtype=float) > least, angle, 0.0)


def _motion_tells(table: pd.DataFrame) -> bool:
    """Whether moving individuals go on in the direction of their last step rather than in that of their body."""
    scale = float(table["scale"].iloc[0])
    least = STANDING_SHARE * scale
    past = np.hypot(*(table[f"past_01_{part}"].to_numpy(dtype=float) for part in ("forward", "right")))
    moving = (past > least) & (table["distance"].to_numpy(dtype=float) > least)
    if not moving.any():
        return False
    angle, _ = motion_frame(table[moving], least)
    by_body = 1.0 - np.cos(table["angle"].to_numpy()[moving])
    return bool((1.0 - np.cos(angle)).mean() < _CLEARLY * by_body.mean())


def facing(places: np.ndarray, headings: np.ndarray, stride: int, least: float) -> np.ndarray:
    """Return the direction [N] of each sample of a run as a unit complex number.

    The body's heading where there is one; else the direction of the step that led there, or the last one known
    while the step is no longer than ``least``; x of the tracks before it has ever moved.
    """
    direction = np.full(len(places), np.nan + 0j)
    stepped = places[stride:] - places[:-stride]
    moved = np.abs(stepped) > max(least, 1e-12)
    direction[stride:][moved] = stepped[moved] / np.abs(stepped[moved])
    for phase in range(stride):  # each phase keeps its own last direction
        mine = direction[phase::stride]
        last = np.maximum.accumulate(np.where(np.isnan(mine.real), -1, np.arange(len(mine))))
        direction[phase::stride] = np.where(last >= 0, mine[np.maximum(last, 0)], 1.0)
    body = np.exp(1j * headings)
    return np.where(np.isfinite(headings), body, direction)


def _of_run(run: Run, step: float, least: float, seen: int, steps: int) -> pd.DataFrame | None:
    places, stride = run.places, run.stride
    count = len(places)
    direction = facing(places, run.headings, stride, least)
    # the first time-step has no direction of its own, unless the file has the body's
    now = np.arange(stride, count - stride) if np.isnan(run.headings).any() else np.arange(max(count - stride, 0))
    if not len(now):
        return None
    to_own = np.conj(direction[now])
    moved = (places[now + stride] - places[now]) * to_own
    distance = np.abs(moved)
    before = np.where(now >= stride, np.abs(places[now] - places[np.maximum(now - stride, 0)]) / step, np.nan)
    columns = {
        "scene": run.scene, "id": run.individual, "time": run.start + now * step / stride, "distance": distance,
        "angle": np.asarray(wrap(np.where(distance > 0, -np.angle(moved), 0.0))),
        "heading": np.asarray(wrap(-np.angle(direction[now + stride] * to_own))), "speed": before,
    }  # fmt: skip
    for kind, sign, number in (("past", -1, seen - 1), ("future", 1, steps)):
        for i in range(1, number + 1):
            at = now + sign * i * stride
            inside = (at >= 0) & (at < count)
            seen_from = np.where(inside, (places[np.clip(at, 0, count - 1)] - places[now]) * to_own, np.nan)
            columns[f"{kind}_{i:02d}_forward"] = seen_from.real
            columns[f"{kind}_{i:02d}_right"] = -seen_from.imag
    import pandas as pd

    return pd.DataFrame(columns)


def window_columns(seen: int, steps: int) -> list[str]:
    """Return the names of the columns of the past (nearest first) and of the future, in order."""
    pairs = [("past", i) for i in range(1, seen)] + [("future", i) for i in range(1, steps + 1)]
    return [f"{kind}_{i:02d}_{part}" for kind, i in pairs for part in ("forward", "right")]


def windows_of(columns: Iterable[str]) -> tuple[int, int]:
    """Return how many places a table of transitions has seen (the present one included), and how many steps follow."""
    numbers = {"past": 0, "future": 0}
    for name in columns:
        if found := _WINDOW.match(str(name)):
            numbers[found.group(1)] = max(numbers[found.group(1)], int(found.group(2)))
    return numbers["past"] + 1, numbers["future"]


def validate_transitions(frame: object, *, conditioned: bool = False) -> None:
    """Raise DataError unless ``frame`` is a table of transitions; conditioned: it must know the speed before."""
    import pandas as pd

    if not isinstance(frame, pd.DataFrame):
        raise DataError(f"transitions: expected a pandas DataFrame, got {type(frame).__name__}")
    needed = ["distance", "angle", "heading", *(["speed", "time_step"] if conditioned else [])]
    for column in needed:
        if column not in frame:
            raise DataError(f"transitions: column {column!r} is missing; make them with bayeshunt.transitions(tracks)")
        try:
            numbers = frame[column].to_numpy(dtype=float, na_value=np.nan)
        except (TypeError, ValueError):
            raise DataError(f"transitions: column {column!r} holds {frame[column].dtype}; expected numbers") from None
        wrong = ~np.isfinite(numbers) & (column != "speed") | (numbers < 0) & (column in ("distance", "speed"))
        if wrong.any():
            row = int(np.flatnonzero(wrong)[0])
            raise DataError(f"transitions: row {row}: {column} is {frame[column].iloc[row]}; expected a finite number")
        far = np.flatnonzero((np.abs(numbers) > 2 * FULL_TURN) & (column in ("angle", "heading")))
        if far.size:
            raise DataError(f"transitions: row {far[0]}: {column}: {beyond_a_turn(float(numbers[far[0]]), 2)}")
