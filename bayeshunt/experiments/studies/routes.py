"""Which way round does the hunter choose, and does it get there: against how much it knows of the arena."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Pose
from bayeshunt.episodes.loop import hunt
from bayeshunt.experiments.preparation import learn_room, own_settings
from bayeshunt.experiments.protocol import check_arenas, hunt_seed, learn_model
from bayeshunt.experiments.scores import wilson_interval
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.arena.scanning import scan
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.detour.ways import WayFinder
from bayeshunt.planners.registry import make_planner
from bayeshunt.worlds.maps import map_of

__all__ = ["EXPLORED", "GROUND", "LOOKS", "RAISED", "routes"]

#: Ways to know an arena beside babbling in it.
GROUND, RAISED = "looks", "raised looks"
#: How much it knows: gaits babbled, looks taken.
EXPLORED, LOOKS = (0, 100, 250, 500, 1000, 2000), (1, 5)
#: A side is chosen where the hunter first is so far beside the straight line to the prey, as a share of its length.
_BESIDE = 0.5
#: How far a look reaches [m], and how often it takes a cell for the other kind.
_REACH, _ERROR = 1.2, 0.05


@checked
def routes(
    experiment: str | os.PathLike[str] | ExperimentSettings = "portia",
    *,
    explored: Sequence[int] = EXPLORED,
    looks: Sequence[int] = LOOKS,
    maps: int = 4,
    runs: int = 3,
    seed: int = 0,
    model: ForwardModel | None = None,
    progress: Callable[[int], None] | None = None,
) -> pd.DataFrame:
    """Hunt with planner detour and return which side it chose first and whether it arrived, a row per kind of map.

    experiment: one whose prey does not move. explored: numbers of gaits babbled in the arena beforehand; 0: none.
    looks: numbers of looks around from the start that take the place of babbling, once from the ground, where
    obstacles hide what is behind them, and once from above them. maps: how many such maps of each kind are made, in
    every arena; runs: hunts with each, from every bearing. progress: called with 1 after every hunt.

    Columns: map ("gaits", "looks", "raised looks"), amount, hunts, chose (those that left the straight line for a
    side), right (those whose side was that of the shortest way), right_low, right_high (95 % Wilson, of those that
    chose; chance is 0.5), reached, time_s (mean; a miss counts the time limit).

    The side is the one on which the hunter first is half the straight line's length beside that line; the shortest way
    is the geodesic on the arena's true map. Raises InputError for a wrong number or a prey that moves.
    """
    settings = load_experiment(experiment)
    for name, value in (("maps", maps), ("runs", runs)):
        check_whole(value, name, 1)
    check_whole(seed, "seed", 0)
    if settings.prey.speed > 0:
        raise InputError(f"routes: the prey of {settings.name!r} moves; a side is chosen towards one that does not")
    check_arenas(settings, tuple(settings.arenas))
    known = learn_model(settings, seed) if model is None else model
    kinds = [("gaits", amount) for amount in explored]
    kinds += [(kind, amount) for kind in (GROUND, RAISED) for amount in looks]
    rows = []
    for kind, amount in kinds:
        check_whole(amount, "explored" if kind == "gaits" else "looks", 0 if kind == "gaits" else 1)
        found = []
        for arena in settings.arenas:
            for number in range(maps):
                room = _room(settings, arena, kind, amount, seed + number, known)
                found += _hunts(settings, arena, room, known, runs, hunt_seed(seed, number, amount), progress)
        rows.append({"map": kind, "amount": amount, **_summary(pd.DataFrame(found))})
    frame = pd.DataFrame(rows)
    frame.attrs = {
        "experiment": settings.name,
        "scaled": settings.scaled,
        "note": settings.note,
        "seed": int(seed),
        "maps": int(maps),
    }
    return frame


def _room(
    settings: ExperimentSettings, arena: str, kind: str, amount: int, seed: int, model: ForwardModel
) -> RoomModel:
    """What the hunter knows of an arena."""
    if kind == "gaits":
        return learn_room(settings, arena=arena, steps=amount, seed=seed, model=model) if amount else RoomModel.empty()
    space = scan(
        map_of(settings.arenas[arena]), settings.protocol.hunter_pose, settings.robot.body.body_length, looks=amount,
        reach=_REACH, above=kind == RAISED, error=_ERROR, rng=np.random.default_rng([seed, amount]),
    )  # fmt: skip
    return replace(RoomModel.empty(), space=space)


def _hunts(
    settings: ExperimentSettings, arena: str, room: RoomModel, model: ForwardModel, runs: int, seed: int,
    progress: Callable[[int], None] | None,
) -> list[dict[str, Any]]:  # fmt: skip
    """One row per hunt: the side chosen, the side of the shortest way, whether it arrived, and when."""
    planner = make_planner("detour", model, **{**own_settings(settings, "detour"), "room": room})
    rows = []
    for index, theta in enumerate(settings.protocol.thetas):
        hunter, prey = settings.starting_poses(float(theta))
        shortest = _shortest(settings, arena, hunter, prey)
        for run in range(runs):
            episode = hunt(settings, planner, arena=arena, theta=theta, seed=hunt_seed(seed, index, run))
            side = _side(hunter, prey, episode.trail[["hunter_x", "hunter_y"]].to_numpy())
            rows.append({"side": side, "shortest": shortest, "reached": episode.caught, "time": episode.time})
            if progress is not None:
                progress(1)
    return rows


def _side(start: Pose, goal: Pose, way: np.ndarray) -> int:
    """The side of the straight line that a way [N, 2] first leaves to: 1 left, -1 right, 0 neither."""
    along = np.array([goal.x - start.x, goal.y - start.y])
    length = float(np.hypot(*along))
    beside = (along[0] * (way[:, 1] - start.y) - along[1] * (way[:, 0] - start.x)) / length
    off = np.abs(beside) >= _BESIDE * length
    return int(np.sign(beside[off.argmax()])) if off.any() else 0


def _shortest(settings: ExperimentSettings, arena: str, start: Pose, goal: Pose) -> int:
    """The side of the shortest way on the arena's true map."""
    place, body = settings.arenas[arena], settings.robot.body.body_length
    seen = start.relative(goal)
    reach = float(np.hypot(place.width, place.height)) if place.walled else 4.0 * float(seen.distance)
    space = scan(
        map_of(place), start, body, looks=1000, reach=reach, above=True, error=0.0, rng=np.random.default_rng(0)
    )
    ways, here, way = WayFinder(space).to(seen.forward, -seen.right), (0.0, 0.0), [(0.0, 0.0)]
    for _ in range(1000):
        here = ways.waypoint(*here)
        way.append(here)
    return _side(Pose(0.0, 0.0, 0.0), Pose(float(seen.forward), -float(seen.right), 0.0), np.array(way))


def _summary(hunts: pd.DataFrame) -> dict[str, Any]:
    chose = hunts[hunts["side"] != 0]
    right = int((chose["side"] == chose["shortest"]).sum())
    low, high = wilson_interval(right, len(chose))
    return {
        "hunts": len(hunts), "chose": len(chose), "right": right, "right_low": low, "right_high": high,
        "reached": int(hunts["reached"].sum()), "time_s": float(hunts["time"].mean()),
    }  # fmt: skip
