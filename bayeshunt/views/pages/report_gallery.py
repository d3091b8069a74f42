"""The gallery of a report: one caught and one missed hunt of every planner and arena, hunted again.

A hunt is made again from its recorded seed and settings. If it does not end as it was recorded
(another model, another version), the report says so.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.errors import BayesHuntError
from bayeshunt.episodes.episode import Episode
from bayeshunt.episodes.loop import hunt, run_hunt
from bayeshunt.experiments.preparation import learn_rooms, prepare_planner
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.asking import Timed
from bayeshunt.views.pages.replay import replay_data

__all__ = ["Shelf", "build_shelf", "choose", "thumbnail"]

#: A trail point every so many control intervals: the player draws straight lines between them.
_EVERY = 2


@dataclass
class Shelf:
    """The hunts of one planner in one arena.

    hunts: the replays, caught first. problem: why there are none, or why not to trust them.
    decision_seconds: processor time of each decision, on this machine, while the report was made.
    """

    planner: str
    arena: str
    hunts: list[dict[str, Any]] = field(default_factory=list)
    problem: str = ""
    decision_seconds: list[float] = field(default_factory=list)


def build_shelf(
    results: pd.DataFrame, settings: ExperimentSettings, model: ForwardModel, planner: str, arena: str, seed: int,
    **source: Any,
) -> Shelf:  # fmt: skip
    """Hunt again one caught and one missed hunt of ``planner`` in ``arena``.

    seed: of the evaluation. source: as ``replay_data`` takes it.
    """
    shelf = Shelf(planner, arena)
    hunts = results[(results["planner"] == planner) & (results["arena"] == arena)]
    try:
        rooms = learn_rooms(settings, [planner], [arena], seed, model)
        mind = prepare_planner(planner, model, settings, rooms, arena)
        for row in choose(hunts):
            episode = hunt(settings, mind, arena=arena, theta=float(row["theta"]), seed=int(row["seed"]))
            # Timed the second time: the first fills the planner's tables.
            run_hunt(settings, Timed(mind, shelf.decision_seconds), arena, float(row["theta"]), int(row["seed"]))
            if (episode.caught, episode.time) != (bool(row["caught"]), float(row["time"])):
                shelf.problem = (
                    f"The hunt of theta {row['theta']:g}, run {row['run']} ended otherwise than recorded "
                    f"({_end(episode.caught, episode.time)}, not {_end(row['caught'], row['time'])}): "
                    "it was evaluated with another model or version; give its model with --model."
                )
            data = replay_data(episode, model=model, every=_EVERY, nodes=False, **source)
            shelf.hunts.append({**data, "run": int(row["run"]), "thumbnail": thumbnail(episode)})
    except BayesHuntError as error:
        shelf.problem = f"Its hunts cannot be made again here: {error}"
    return shelf


def choose(hunts: pd.DataFrame) -> list[dict[str, Any]]:
    """Return the caught hunt of median catch time and the first missed hunt, where there are such."""
    caught, missed = hunts[hunts["caught"]], hunts[~hunts["caught"]]
    chosen = []
    if len(caught):
        chosen.append(caught.sort_values("time", kind="stable").iloc[(len(caught) - 1) // 2])
    if len(missed):
        chosen.append(missed.iloc[0])
    return [{str(key): value for key, value in row.items()} for row in chosen]


def thumbnail(episode: Episode, size: float = 100.0) -> dict[str, Any]:
    """Return both paths as SVG points in a square of ``size``, and where they end."""
    trail = episode.trail.iloc[:: max(1, len(episode.trail) // 80)]
    xs = pd.concat([episode.trail["hunter_x"], episode.trail["prey_x"]])
    ys = pd.concat([episode.trail["hunter_y"], episode.trail["prey_y"]])
    scale = 0.84 * size / max(xs.max() - xs.min(), ys.max() - ys.min(), 1e-6)
    middle = (xs.max() + xs.min()) / 2, (ys.max() + ys.min()) / 2

    def place(x: float, y: float) -> tuple[float, float]:
        return round(size / 2 + (x - middle[0]) * scale, 1), round(size / 2 - (y - middle[1]) * scale, 1)

    paths = {}
    for who in ("hunter", "prey"):
        points = [place(x, y) for x, y in zip(trail[f"{who}_x"], trail[f"{who}_y"], strict=True)]
        points.append(place(episode.trail[f"{who}_x"].iloc[-1], episode.trail[f"{who}_y"].iloc[-1]))
        paths[who] = {"line": " ".join(f"{x},{y}" for x, y in points), "end": points[-1]}
    return paths


def _end(caught: Any, seconds: Any) -> str:
    return f"caught after {seconds:.3f} s" if caught else "missed"
