"""What the replay shows of a decision's alternatives: every node, what it promised against what came, whiskers."""

from __future__ import annotations

from typing import Any

import numpy as np

from bayeshunt.core.geometry import Polar, Pose, wrap
from bayeshunt.core.units import bounds, objective
from bayeshunt.episodes.answers import AnswerCells
from bayeshunt.episodes.episode import Episode
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.views import theme
from bayeshunt.views.pages.page import number

__all__ = ["asked_again", "considered", "gait_looks", "realised", "whiskers"]

_TENTHS = 10_000.0  # 0.1 mm and 0.1 mrad are finer than a screen can show


def considered(row: dict[str, Any], model: ForwardModel | None, previous: str | None) -> dict[str, Any] | None:
    """Return every node as icicle.js takes them; None where the episode keeps none.

    Where a trace does not say where a gait leads, the model does.
    """
    gaits = row.get("considered_gait")
    if gaits is None:
        return None
    names = list(dict.fromkeys(map(str, gaits)))
    at = {name: i for i, name in enumerate(names)}
    ends = np.stack([_known(row, part, len(gaits)) for part in ("forward", "right", "heading")])
    if model is not None and np.isnan(ends[0]).all() and set(names) <= set(model.gaits.names):
        after = model.after(previous)
        expected = {name: after.predict(name) for name in names}
        ends = np.array([[expected[str(g)].forward, expected[str(g)].right, expected[str(g)].heading] for g in gaits]).T
    flat = [None if v != v else round(v * _TENTHS) for v in ends.T.ravel().tolist()]
    values = [objective(float(value), row["objective"])[0] for value in _known(row, "value", len(gaits))]
    return {
        "names": names,
        "gait": [at[str(gait)] for gait in gaits],
        "parent": [int(parent) for parent in row["considered_parent"]],
        "value": [number(value, 5) for value in values],
        "end": None if all(v is None for v in flat) else flat,
        "chosen": np.flatnonzero(row["considered_chosen"]).tolist(),
    }


def _known(row: dict[str, Any], name: str, count: int) -> np.ndarray:
    """A column of the nodes; NaN where the trace has none."""
    values = row[f"considered_{name}"]
    return np.full(count, np.nan) if values is None else np.asarray(values, dtype=float)


def realised(row: dict[str, Any], episode: Episode, duration: float) -> float | None:
    """Return what became of a plan's value, in the unit that people read; None where nobody can say.

    A distance to the prey, or to the point aimed at, is that at the time when the sequence would have ended; a time to
    the catch is what it then took.
    """
    what, now = str(row["objective"]), float(row["time"])
    if what.endswith("[s]") and "capture" in what:
        return number(episode.time - now) if episode.caught else None
    end, trail = now + duration * len(row["planned_gaits"]), episode.trail
    if not what.endswith("[m]") or trail.empty or end > float(trail["time"].iloc[-1]) + 0.05:
        return None
    then = trail.iloc[int(np.searchsorted(trail["time"].to_numpy(), end - 1e-6).clip(max=len(trail) - 1))]
    if "to the prey" in what:
        place = (then["prey_x"], then["prey_y"])
    elif "to the point aimed at" in what and np.isfinite(row["target_distance"]):
        hunter = Pose(*(row[f"hunter_{k}"] for k in Pose._fields))
        place = hunter.compose(Polar(*(row[f"target_{k}"] for k in Polar._fields)))[:2]
    else:
        return None
    gap = float(np.hypot(then["hunter_x"] - place[0], then["hunter_y"] - place[1]))
    return number(objective(gap, what)[0])


def asked_again(row: dict[str, Any], inverse: InverseModel | None, previous: str | None) -> Posterior | None:
    """Return the answer that a decision rests on, asked of the model again; None if it is not the recorded one."""
    if inverse is None or row["posterior"] is None or not np.isfinite(row["target_distance"]):
        return None
    answer = inverse.after(previous).posterior(float(row["target_distance"]), float(row["target_angle"]))
    return answer if np.allclose(answer.values, row["posterior"], atol=1e-9) else None


def whiskers(rests: AnswerCells | None) -> list[list[Any]] | None:
    """Return low and high end of every P(Gait | target), and both in words; None where nobody can say."""
    if rests is None or rests.within is None:
        return None
    return [[number(low, 4), number(high, 4), bounds(low, high)] for low, high in rests.within.T.tolist()]


def gait_looks(episode: Episode) -> dict[str, dict[str, Any]]:
    """Return the name of the colour of each gait executed, by how it turned the hunter, and how many stripes it has.

    Only gaits that share their colour with another have stripes.
    """
    turns = _turns(episode)
    named = zip(turns, theme.gait_names(turns.values()), strict=True)
    striped = zip(turns, theme.gait_stripes(turns.values()), strict=True)
    return {
        "colours": {gait: f"{side}-{rank}" for gait, (side, rank) in named},
        "stripes": {gait: many for gait, many in striped if many},
    }


def _turns(episode: Episode) -> dict[str, float]:
    """By how much each gait executed turned the hunter on average [rad clockwise], halved."""
    frame, trail = episode.frame, episode.trail
    if trail.empty:
        return {}
    times, headings = trail["time"].to_numpy(), np.unwrap(trail["hunter_theta"].to_numpy())
    starts = [*frame["time"].tolist(), float(times[-1])]
    at = np.interp(starts, times, headings)
    turns: dict[str, list[float]] = {}
    for gait, turned in zip(frame["gait"].tolist(), np.diff(at).tolist(), strict=True):
        turns.setdefault(str(gait), []).append(float(wrap(-turned)) / 2)
    return {gait: float(np.mean(values)) for gait, values in turns.items()}
