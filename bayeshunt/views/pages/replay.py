"""The replay of a hunt: one page that plays it, in step with what the hunter knew.

It shows what ``episode.frame`` holds and nothing else, so that an episode read from a file replays
as well as a fresh one.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import parse
from bayeshunt.config.plausibility import warn_of_other_motion
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.config.schema.legs import legs_at_rest
from bayeshunt.core import units
from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_kind
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import FloatArray, Polar, Pose, wrap
from bayeshunt.core.units import objective
from bayeshunt.episodes.answers import AnswerCells, answer_cells, stored
from bayeshunt.episodes.episode import Episode
from bayeshunt.files.atomic import write_text
from bayeshunt.files.endings import check_ending
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.views import grounds
from bayeshunt.views.opened import opened, opened_cells
from bayeshunt.views.pages.commands import hunt_command
from bayeshunt.views.pages.page import embed, number, render
from bayeshunt.views.pages.replay_belief import belief_of, field_of_view
from bayeshunt.views.pages.replay_search import asked_again, considered, gait_looks, realised, whiskers

__all__ = ["SCRIPTS", "STYLES", "replay_data", "replay_html", "write_replay"]

#: What the player of a hunt is made of, for pages that have one.
STYLES = ("player.css", "trace.css")
SCRIPTS = ("dom.js", "units.js", "trace.js", "icicle.js", "lanes.js", "field.js", "player.js")

#: Cells of a table of expected counts that are shown, the likeliest.
_LIKELIEST = 60


@checked
def write_replay(
    episode: Any,
    path: str | os.PathLike[str],
    *,
    model: ForwardModel | None = None,
    source: Sequence[str] = (),
) -> None:
    """Write the replay of ``episode`` as one HTML file, replaced atomically; see :func:`replay_html`."""
    check_ending(path, "pages", ".html")
    write_text(path, replay_html(episode, model=model, source=source))


def replay_html(episode: Any, *, model: ForwardModel | None = None, source: Sequence[str] = ()) -> str:
    """Return a self-contained page that plays ``episode``, or several in step: of one seed they start alike.

    episode: an Episode, or a list of them.
    model: where planners that keep no path (reactive, prediction) expect their gait to lead is drawn
        from it; without it they show their aim alone. Of an episode from a file it also gives the babbled rows behind
        their posteriors, and of files of earlier versions how sure these are.
    source: options of the command shown at the foot, as ``commands.model_option`` gives them.

    Raises InputError if that is no episode, or if a hunt ended before its first decision.
    """
    episodes: Sequence[Any] = episode if isinstance(episode, (list, tuple)) else [episode]
    hunts = [replay_data(one, model=model, source=source) for one in episodes]
    title = f"{hunts[0]['title']}: {hunts[0]['outcome']}" if len(hunts) == 1 else f"{len(hunts)} hunts in step"
    return render(
        "replay.html.j2", ["page.css", *STYLES], [*SCRIPTS, "replay.js"],
        hunts=hunts, title=title, data=[embed(hunt) for hunt in hunts],
    )  # fmt: skip


def replay_data(
    episode: Episode,
    *,
    model: ForwardModel | None = None,
    source: Sequence[str] = (),
    every: int = 1,
    nodes: bool = True,
) -> dict[str, Any]:
    """Return what the player draws, as plain values for JSON; ``every``: keep each so many-th point of the trail;
    ``nodes``: keep every alternative that a decision considered.

    World poses are [x, y, theta] in metres and radians counter-clockwise, what the hunter sees is
    [distance, angle, heading], clockwise.
    """
    check_kind(episode, "episode", Episode, "an Episode, as hunt() returns it")
    origin = episode.provenance
    settings = parse(ExperimentSettings, origin["settings"], "the episode's settings")
    if episode.frame.empty:
        raise InputError("nothing to replay: the hunt ended before its first decision")
    if model is not None:
        check_kind(model, "model", ForwardModel, "a ForwardModel")
        robot = settings.robot
        if (difference := model.gaits.difference(robot.gaits, "the model's robot", robot.name)) is not None:
            raise InputError(f"{difference}; give a model of the robot that hunted")
        warn_of_other_motion(model.provenance, robot)
    planner, arena, theta, seed = (origin[key] for key in ("planner", "arena", "theta", "seed"))
    place = settings.arenas[arena]
    records: list[dict[str, Any]] = episode.frame.to_dict("records")  # type: ignore[assignment]
    before = [None, *(row["gait"] for row in records)]
    steps = [
        {
            **_step(row, settings, model, answer, previous),
            "realised": realised(row, episode, settings.robot.gait_duration),
            "considered": considered(row, model, previous) if nodes else None,
        }
        for row, previous, answer in zip(records, before, _answers(episode, model, records, before), strict=False)
    ]
    return {
        "title": f"{planner}, {arena} arena, prey first at {units.theta(theta)}",
        "planner": planner, "arena": arena, "theta": theta, "seed": str(seed),
        "caught": episode.caught,
        "outcome": f"caught after {episode.time:.2f} s" if episode.caught else f"not caught in {episode.time:g} s",
        "spent": episode.spent,
        "radius": [settings.robot.body.body_length / 2, settings.prey.body.diameter / 2],
        "legs": [[round(v, 4) for v in leg] for leg in legs_at_rest(settings.robot.body)],
        "walls": [place.width, place.height] if place.walled else None,
        "obstacles": [[[round(v, 4) for v in at] for at in obstacle.outline()] for obstacle in place.obstacles],
        "trail": _trail(episode, every),
        **gait_looks(episode),
        "steps": steps,
        "fov": field_of_view(settings),
        "bins": [number(width) for width in _bin_widths(settings)],
        "note": settings.note,
        "command": hunt_command(settings, planner, arena, theta, seed, source=source),
    }  # fmt: skip


def _answers(
    episode: Episode, model: ForwardModel | None, records: list[dict[str, Any]], before: list[str | None]
) -> list[Posterior | None]:
    """The answer that each decision rests on: its plan's own, or where that carries none the model's, asked again."""
    own = [plan.answer for plan in episode.plans] or [None] * len(records)
    asks = any(row["posterior"] is not None and answer is None for row, answer in zip(records, own, strict=True))
    if not asks or model is None:
        return own
    inverse, rows = InverseModel(model), zip(own, records, before, strict=False)
    return [asked_again(row, inverse, previous) if answer is None else answer for answer, row, previous in rows]


def _trail(episode: Episode, every: int) -> dict[str, list[Any]]:
    """Both robots' poses from the start; 0.1 mm and 0.1 mrad are finer than a screen can show."""
    kept = np.arange(len(episode.trail)) % every == every - 1
    kept[-1:] = True  # the end
    names = ["time", *(f"{who}_{k}" for who in ("hunter", "prey") for k in Pose._fields)]
    trail = pd.concat([episode.frame.iloc[:1][names], episode.trail.loc[kept, names]])
    return {
        "time": [round(t, 4) for t in trail["time"].tolist()],
        **{who: trail[[f"{who}_{k}" for k in Pose._fields]].round(4).to_numpy().tolist() for who in ("hunter", "prey")},
    }


def _step(
    row: dict[str, Any],
    settings: ExperimentSettings,
    model: ForwardModel | None,
    answer: Posterior | None,
    previous: str | None,
) -> dict[str, Any]:
    """Everything that the panels and the canvas show of one decision."""
    hunter = Pose(*(row[f"hunter_{k}"] for k in Pose._fields))
    value, what = objective(row["value"], row["objective"])
    target = _polar(row, "target")
    predicted = _moving(_stored_path(row, "predicted"))
    plan = [str(gait) for gait in row["planned_gaits"]]
    prey_rows = [] if row.get("prey_table") is None else [list(map(float, cell)) for cell in row["prey_table"]]
    if any(cell[3] % 1 for cell in prey_rows):  # expected counts: many cells, most of them hardly likely
        prey_rows = sorted(prey_rows, key=lambda cell: -cell[3])[:_LIKELIEST]
    observed = _polar(row, "observed")
    rests = stored(row) if answer is None else answer_cells(answer)
    return {
        "number": int(row["step"]), "time": number(row["time"]), "gait": row["gait"],
        "plan": [[gait, len(list(run))] for gait, run in groupby(plan)],
        "value": number(value), "objective": what, "nodes": int(row["nodes"]),
        "seen": _numbers(_polar(row, "seen")), "target": _numbers(target),
        "aim": _world(hunter, target),
        "known": bool(row["prey_known"]), "observations": int(row["prey_observations"]),
        "expected": _numbers(_polar(row, "expected")),
        "prey": [[number(v) for v in cell] for cell in prey_rows],
        "fresh": _cell_of(observed, prey_rows, settings),
        "predicted": _world_path(hunter, predicted),
        "aimed": _aimed(predicted, target),
        "planned": _world_path(hunter, _stored_path(row, "planned") or _expected_path(plan, model, previous)),
        "bars": {**_bars(row, settings), "within": whiskers(rests)},
        "opened": _opened(rests, answer, settings),
        "belief": belief_of(row, hunter),
        "energy": number(row["energy"]) if "energy" in row else None, "falls": int(row.get("falls", 0)),
    }  # fmt: skip


def _opened(rests: AnswerCells | None, answer: Posterior | None, settings: ExperimentSettings) -> dict[str, Any] | None:
    """What a decision's posterior is made of; with rows where an answer is at hand."""
    if answer is not None:
        return opened(answer)
    return None if rests is None else opened_cells(rests, settings.robot.gaits.names, "")


def _bars(row: dict[str, Any], settings: ExperimentSettings) -> dict[str, Any]:
    """The posterior over gaits or, of a planner that has none, the value of each first gait."""
    if row["posterior"] is not None:
        return {
            "kind": "posterior",
            "title": "Posterior over gaits",
            "caption": f"P(Gait | Distance, Angle) at the aim: P(evidence) {row['evidence_probability']:.3g}, "
            f"support {grounds.rows(row['support'])}, "
            f"entropy {abs(row['posterior_entropy']):.2f} bits",
            "gaits": list(settings.robot.gaits.names),
            "values": [number(p) for p in row["posterior"]],
        }
    gaits, values = row.get("alternative_gaits"), row.get("alternative_values")
    if gaits is None or values is None:
        gaits = values = []
    what = objective(0.0, row["objective"])[1]
    known = [
        (gait, objective(value, row["objective"])[0])
        for gait, value in zip(gaits, values, strict=True)
        if np.isfinite(value)
    ]
    least = dict(known).get(row["gait"], np.inf) <= min((value for _, value in known), default=0.0)
    return {
        "kind": "values",
        "title": "Values of the first gaits" if known else "Alternatives",
        "caption": f"Least value under each first gait ({what}){'; less is better' if least else ''}. "
        "This planner has no posterior."
        if known
        else "This planner keeps neither a posterior nor a value per gait.",
        "gaits": [gait for gait, _ in known],
        "values": [number(value) for _, value in known],
    }


def _polar(row: dict[str, Any], name: str) -> Polar | None:
    pose = Polar(*(row[f"{name}_{k}"] for k in Polar._fields))
    return pose if np.isfinite(pose.distance) else None


def _stored_path(row: dict[str, Any], name: str) -> Polar[FloatArray] | None:
    """A path kept in the table: Polar of arrays [T + 1]."""
    parts = [row.get(f"{name}_{k}") for k in Polar._fields]
    return None if any(part is None for part in parts) else Polar(*(np.asarray(part, dtype=float) for part in parts))


def _moving(path: Polar[FloatArray] | None) -> Polar[FloatArray] | None:
    """The path, or None where the prey is taken to stand still: there is nothing to draw."""
    if path is None or (np.ptp(path.forward) < 1e-9 and np.ptp(path.right) < 1e-9):
        return None
    return path


def _expected_path(gaits: list[str], model: ForwardModel | None, previous: str | None) -> Polar[FloatArray] | None:
    """Where the forward model expects a sequence of gaits to lead after ``previous``, as a Polar of arrays [T + 1]."""
    if model is None:
        return None
    poses = [Polar(0.0, 0.0, 0.0)]
    for gait in gaits:
        poses.append(poses[-1].compose(model.after(previous).predict(gait)))
        previous = gait
    return Polar(*(np.array(part) for part in zip(*poses, strict=True)))


def _world_path(hunter: Pose, path: Polar[FloatArray] | None) -> list[list[float | None]]:
    if path is None:
        return []
    poses = np.stack(hunter.compose(path), axis=1).round(4).tolist()
    return [[x, y, theta if np.isfinite(theta) else None] for x, y, theta in poses]  # a heading may not be known


def _world(hunter: Pose, seen: Polar | None) -> list[float] | None:
    return None if seen is None else [round(float(v), 4) for v in hunter.compose(seen)[:2]]


def _numbers(pose: Polar | None) -> list[float | None] | None:
    return None if pose is None else [number(v) for v in pose]


def _aimed(predicted: Polar[FloatArray] | None, target: Polar | None) -> int:
    """How many steps ahead the prey pose is that the plan aims at; -1 if it aims at none of them."""
    if predicted is None or target is None:
        return -1
    gaps = np.hypot(predicted.forward - target.forward, predicted.right - target.right)
    return int(gaps.argmin()) if gaps.min() < 1e-6 else -1


def _cell_of(observed: Polar | None, rows: list[list[float]], settings: ExperimentSettings) -> int:
    """Row of the prey table that the transition just observed fell into; -1 if none did."""
    if observed is None or not rows:
        return -1
    cells, widths = np.array(rows), _bin_widths(settings)
    gaps = [cells[:, 0] - observed.distance, wrap(cells[:, 1] - observed.angle), wrap(cells[:, 2] - observed.heading)]
    off = [np.abs(gap) / width for gap, width in zip(gaps, widths, strict=True)]  # in bins
    return int(np.max(off, axis=0).argmin())


def _bin_widths(settings: ExperimentSettings) -> tuple[float, float, float]:
    """Widths of the prey table's bins: distance [m], angle, heading [rad]."""
    model = settings.model
    turns = (2 * np.pi / bins for bins in (model.angle_bins, model.heading_bins))
    return (model.distance_bin * settings.robot.body.body_length, *turns)  # type: ignore[return-value]
