"""What a camera costs and the planner search gets back: ``python -m benchmarks.sensing [--runs 34] [--seeds 0 1 2]``.

A row a camera: success with counts and a 95 % interval, mean time (a miss counts as the time limit). Obstacles, a lure
behind them, and a hexapod that sees are rows as well. Then, of other hunts, how calibrated the belief is, how near the
expected counts of the prey come to what it did, and what a decision costs beside one of intercept. Every figure is
added to ``--out`` as soon as it is there, and what is there is not measured again: the same command goes on where it
was stopped. Delete the file, or name another, when the code has changed.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Callable, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import bayeshunt as bh
from bayeshunt.core.geometry import FloatArray, Polar, Pose, in_frame
from bayeshunt.episodes.knowledge import known_to
from bayeshunt.episodes.pursuit import Pursuit
from bayeshunt.experiments.preparation import learn_rooms, prepare_planner
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.perception.trackers.particle_belief import ParticleBelief
from benchmarks.sensing_results import Key, Results, pooled

__all__ = ["MEASURES", "ROWS", "Row", "calibration", "decision_ratio", "expected_counts", "hunts", "row_settings"]

_RESULTS = Path(__file__).parent / "results" / "sensing.csv"
#: Hunts a bearing of which more is asked than how they end.
_MOST_RUNS = 15
_HEADING = {"camera.heading_noise_deg": 20.0}
_BAD = {
    "camera.detection": 0.7, "camera.clutter": 0.2, "camera.pixel_noise": 1.5, "camera.bearing_noise_deg": 3.0
}  # fmt: skip


class Row(NamedTuple):
    """A row of the table: arena, camera (none: as the preset says), what differs from it, preset, and who hunts."""

    arena: str
    camera: str
    changes: dict[str, Any] = {}  # never written to  # noqa: RUF012
    preset: str = "paper"
    planner: str = "search"


#: Name -> where and with what is hunted.
ROWS = {
    "walled, wide": Row("walled", "camera_wide"),
    "walled, narrow": Row("walled", "camera_narrow"),
    "walled, narrow, start unknown": Row("walled", "camera_narrow", {"start": "unknown"}),
    "walled, narrow, bad": Row("walled", "camera_narrow", _BAD),
    "walled, exact": Row("walled", ""),
    "open, wide": Row("open", "camera_wide"),
    "open, wide, heading seen (20 deg)": Row("open", "camera_wide", _HEADING),
    "open, narrow": Row("open", "camera_narrow"),
    "open, omni, heading seen (20 deg)": Row("open", "camera_omni", _HEADING),
    "open, K213": Row("open", "camera_k213"),
    "open, exact": Row("open", ""),
    "barrier, lure": Row("barrier", "", preset="detour", planner="detour"),
    "barrier, lure, search": Row("barrier", "", preset="detour"),
    "U, lure": Row("u", "", preset="detour", planner="detour"),
    "U, lure, search": Row("u", "", preset="detour"),
    "clutter, intercept_walls": Row("clutter", "", preset="clutter", planner="intercept_walls"),
    "clutter, detour": Row("clutter", "", preset="clutter", planner="detour"),
    "clutter, search": Row("clutter", "", preset="clutter"),
    "clutter, wide, detour": Row("clutter", "camera_wide", preset="clutter", planner="detour"),
    "clutter, wide, search": Row("clutter", "camera_wide", preset="clutter"),
    "legs, open, wide": Row("open", "camera_wide", preset="legs_camera"),
    "legs, walled, wide": Row("walled", "camera_wide", preset="legs_camera"),
}


def row_settings(row: Row, runs: int = 34, **changes: Any) -> bh.ExperimentSettings:
    """Return a row's preset with its camera."""
    sensing = {f"sensing.{key}": value for key, value in row.changes.items()}
    camera = {"sensing.preset": row.camera} if row.camera else {}
    return bh.load_experiment(row.preset, {**camera, **sensing, "protocol.runs": runs, **changes})


def hunts(name: str, planner: str, seed: int, runs: int, tracker: str = "") -> dict[str, float]:
    """Return of a row's hunts on an evaluation seed: caught, hunts, the sums of the times [s] and of their squares."""
    row = ROWS[name]
    settings = row_settings(row, runs, **({"sensing.tracker": tracker} if tracker else {}))
    model = _model(row.preset, seed)
    frame = bh.evaluate(settings, planners=planner, arenas=row.arena, seed=seed, jobs=1, model=model)
    times = frame["time"].to_numpy()
    return {
        "caught": int(frame["caught"].sum()), "hunts": len(times), "time": float(times.sum()),
        "squares": float(times @ times),
    }  # fmt: skip


@cache
def _model(preset: str, seed: int) -> Any:
    """The forward model of all rows of a preset."""
    return learn_model(bh.load_experiment(preset), seed)


def _running(row: Row, runs: int, seed: int, planner: str = "search") -> Any:
    """Yield (pursuit, planner) of every hunt of a row, to be stepped."""
    settings = row_settings(row, runs)
    model = _model(row.preset, seed)
    mind = prepare_planner(
        planner, model, settings, learn_rooms(settings, [planner], [row.arena], seed, model), row.arena
    )
    for number, theta in enumerate(settings.protocol.thetas):
        for run in range(runs):
            hunt_seed = 1000 * seed + 100 * number + run
            yield Pursuit(settings, row.arena, theta, hunt_seed, known=known_to(mind)), mind


def calibration(name: str, runs: int, seed: int) -> dict[str, float]:
    """Return the share of decisions in which the 50 and the 90 % region of the particles hold the true prey.

    A region is the ellipse of the particles' covariance about their mean that holds so much of their weight. seen_50,
    seen_90: of the ``seen`` decisions since the prey was first seen: before that, a region is of what is assumed.
    """
    inside, seen = [], []
    for pursuit, mind in _running(ROWS[name], runs, seed):
        while not pursuit.done:
            situation = pursuit.situation
            truth = in_frame(pursuit.moment.poses["prey"], pursuit.trial.start)
            inside.append(_region(situation.belief, truth))
            seen.append(situation.belief.sightings > 0)
            pursuit.step(mind.plan(situation, rng=pursuit.rng).gait)
    held, since = np.array(inside), np.array(inside)[seen]
    return {
        "in_50": float((held < 0.5).mean()), "in_90": float((held < 0.9).mean()), "decisions": len(held),
        "seen_50": float((since < 0.5).mean()), "seen_90": float((since < 0.9).mean()), "seen": len(since),
    }  # fmt: skip


def _region(belief: ParticleBelief, truth: Pose) -> float:
    """Weight of the particles nearer to their mean than the truth is, by their own covariance."""
    cloud = belief.cloud
    off = np.stack([cloud.x, cloud.y])
    mean = off @ cloud.weight
    off = off - mean[:, None]
    inverse = np.linalg.inv((off * cloud.weight) @ off.T + 1e-12 * np.eye(2))
    there = np.array([truth.x, truth.y]) - mean
    near = np.einsum("in,ij,jn->n", off, inverse, off) < there @ inverse @ there
    return float(cloud.weight[near].sum())


def expected_counts(name: str, runs: int, seed: int) -> dict[str, float]:
    """Return the total variation between expected counts and the prey's true transitions, and the false turns.

    Bins: 20 mm by 30 deg. turns: expected share of steps whose heading changes by 0.4 rad or more.
    """
    true: Counter[tuple[int, int]] = Counter()
    expected: Counter[tuple[int, int]] = Counter()
    turned = learned = 0.0
    for pursuit, mind in _running(ROWS[name], runs, seed):
        before = None
        while not pursuit.done:
            situation = pursuit.situation
            now = in_frame(pursuit.moment.poses["prey"], pursuit.trial.start)
            if before is not None:
                true[_cells(before.relative(now))[0]] += 1
                told = situation.belief.expected
                if told is not None:
                    transitions, weights = told
                    for cell, weight in zip(_cells(transitions), weights.tolist(), strict=True):
                        expected[cell] += weight
                    turned += float(weights[np.abs(transitions.heading) >= 0.4].sum())
                    learned += 1
            before = now
            pursuit.step(mind.plan(situation, rng=pursuit.rng).gait)
    steps = sum(true.values())
    off = sum(abs(true[cell] / steps - expected[cell] / max(learned, 1)) for cell in true.keys() | expected.keys())
    return {"total_variation": 0.5 * off, "turns": turned / max(learned, 1), "learned": learned / steps, "steps": steps}


def _cells(transition: Polar[FloatArray] | Polar) -> list[tuple[int, int]]:
    distance, heading = np.atleast_1d(transition.distance), np.atleast_1d(transition.heading)
    turns = np.floor((heading + np.pi) / np.radians(30.0) + 0.5).astype(int) % 12
    return list(zip((distance / 0.02).astype(int).tolist(), turns.tolist(), strict=True))


def decision_ratio(name: str, runs: int, seed: int) -> dict[str, float]:
    """Return CPU milliseconds of a decision (look, belief and plan), 99th percentile, of search and of intercept."""
    found = {}
    for label, row, planner in (
        ("search", ROWS[name], "search"),
        ("intercept", Row(ROWS[name].arena, ""), "intercept"),
    ):
        spent = []
        for pursuit, mind in _running(row, runs, seed, planner):
            while not pursuit.done:
                start = time.thread_time()
                gait = mind.plan(pursuit.situation, rng=pursuit.rng).gait
                spent.append(time.thread_time() - start)
                pursuit.step(gait)
        found[label] = 1000.0 * float(np.percentile(spent, 99))
        found[f"{label}_median"] = 1000.0 * float(np.median(spent))
    return {**found, "ratio": found["search"] / found["intercept"]}


#: Name -> what is measured beside the hunts: calibration on every seed, the others on the first.
MEASURES: dict[str, Callable[[str, int, int], dict[str, float]]] = {
    "calibration": calibration, "counts": expected_counts, "cost": decision_ratio
}  # fmt: skip


def main() -> None:
    """Print everything, a line at a time."""
    options = _parser().parse_args()
    results = Results(options.out)
    for name in options.rows:
        row = ROWS[name]
        for planner in (options.planners or [row.planner]) if "hunts" in options.only else ():
            tracker = options.tracker if row.camera else ""
            parts = [
                results.get(
                    Key(name, planner, tracker, seed, options.runs), "hunts",
                    partial(hunts, name, planner, seed, options.runs, tracker),
                )
                for seed in options.seeds
            ]  # fmt: skip
            print(_line(name, planner, tracker, pooled(parts)), flush=True)
    for name in (name for name in options.rows if ROWS[name].camera and ROWS[name].preset == "paper"):
        for measured in (measure for measure in MEASURES if measure in options.only):
            runs, measure = min(options.runs, _MOST_RUNS), MEASURES[measured]
            parts = [
                results.get(Key(name, "search", "", seed, runs), measured, partial(measure, name, runs, seed))
                for seed in (options.seeds if measured == "calibration" else options.seeds[:1])
            ]
            facts = together(parts) if measured == "calibration" else parts[0]
            print(f"{name}, {measured}: " + ", ".join(f"{k} {v:.3g}" for k, v in facts.items()), flush=True)


def together(parts: Sequence[dict[str, float]]) -> dict[str, float]:
    """Return the shares that :func:`calibration` found on several seeds, of all decisions together."""
    found: dict[str, float] = {}
    for count, shares in (("decisions", ("in_50", "in_90")), ("seen", ("seen_50", "seen_90"))):
        whole = sum(part[count] for part in parts)
        found |= {share: sum(part[share] * part[count] for part in parts) / whole for share in shares}
        found[count] = whole
    return found


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=34, help="hunts per bearing and seed")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument(
        "--rows", nargs="+", default=list(ROWS), choices=list(ROWS), metavar="ROW", help=", ".join(map(repr, ROWS))
    )
    parser.add_argument("--planners", nargs="+", default=[], help="instead of the row's own")
    parser.add_argument("--tracker", default="", help="instead of particles: exact (the last sighting), kalman")
    parser.add_argument("--only", nargs="+", default=["hunts", *MEASURES], choices=["hunts", *MEASURES])
    parser.add_argument("--out", type=Path, default=_RESULTS, help="where figures are added, and read from")
    return parser


def _line(name: str, planner: str, tracker: str, facts: dict[str, float]) -> str:
    by = f"{planner}, {tracker}" if tracker else planner
    return (
        f"| {name} | {by} | {100 * facts['success']:.1f} % "
        f"({facts['caught']}/{facts['hunts']}; {100 * facts['low']:.1f} to {100 * facts['high']:.1f}) | "
        f"{facts['time']:.1f} ± {facts['time_se']:.1f} s |"
    )


if __name__ == "__main__":
    main()
