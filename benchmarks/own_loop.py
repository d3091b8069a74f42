"""People followed by ``bh.Hunter`` in a loop of one's own: ``python -m benchmarks.own_loop FOLDER [--walkers 200]``.

FOLDER holds recordings of people, a .txt file a scene, 2.5 rows a second, metres. No simulator: the hunter's body is a
point that moves as its gait says, with noise of 5 %, and has babbled 1,000 times. It starts 2.5 m from the walker, once
to catch him (0.51 m), once to keep him company (0.5 to 2.5 m; it goes for the place 1.5 m behind him).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import FloatArray
from bayeshunt.core.protocols import TargetModel
from bayeshunt.data.steps import Run, runs
from bayeshunt.experiments.studies.following import summary
from bayeshunt.models.target.following import ConstantVelocity
from benchmarks.command import command, quiet_pgmpy, show

__all__ = ["follow", "report"]

_STEP = 0.8  # s, two rows
_LEAST = 8.0  # s that a walker is seen
_NEAR, _FAR, _CAUGHT = 0.5, 2.5, 0.51  # m
_GAITS = bh.GaitRepertoire(
    tuple(
        bh.Gait(name, command)  # metres ahead, radians to the left, in one step
        for name, command in {
            "ahead": (1.28, 0.0), "left": (1.2, 0.4), "right": (1.2, -0.4), "hard left": (0.8, 1.2),
            "hard right": (0.8, -1.2), "slow": (0.5, 0.0), "slow left": (0.4, 0.6), "slow right": (0.4, -0.6),
            "turn left": (0.1, 1.6), "turn right": (0.1, -1.6),
        }.items()
    ), body_length=0.5, duration=_STEP,
)  # fmt: skip


def _moved(pose: bh.Pose, gait: bh.Gait, rng: np.random.Generator) -> bh.Pose:
    ahead, turn = np.array(gait.command) * rng.normal(1.0, 0.05, size=2)
    half = pose.theta + turn / 2
    return bh.Pose(pose.x + ahead * np.cos(half), pose.y + ahead * np.sin(half), pose.theta + turn)


def _body() -> bh.ForwardModel:
    rng, babbler, pose = np.random.default_rng(0), bh.Babbler(_GAITS, seed=0), bh.Pose(0.0, 0.0, 0.0)
    babbler.record(pose)
    for _ in range(1000):
        pose = _moved(pose, babbler.next(), rng)
        babbler.record(pose)
    return bh.ForwardModel.fit(babbler.table(), _GAITS, 0.03)


def _loop(body: bh.ForwardModel, path: FloatArray, start: bh.Pose, known: TargetModel | None, behind: float) -> Any:
    """Whether and when [s] it has caught the walker (never if ``behind`` him [m]), and the distances [m]."""
    hunter = bh.Hunter("planning", body, seed=0, prey_model=known)
    pose, noise, gaps = start, np.random.default_rng(1), []
    for here, there in pairwise(path.tolist()):
        gaps.append(abs(here - complex(pose.x, pose.y)))
        if not behind and gaps[-1] < _CAUGHT:
            return True, (len(gaps) - 1) * _STEP, gaps
        facing = (there - here) / abs(there - here) if abs(there - here) > 1e-3 else 1.0 + 0j
        goal = here - behind * facing
        plan = hunter.step(pose, bh.Pose(goal.real, goal.imag, float(np.angle(facing))))
        pose = _moved(pose, _GAITS[_GAITS.index(plan.gait)], noise)
    return False, (len(path) - 1) * _STEP, gaps


def _models(others: pd.DataFrame) -> dict[str, TargetModel | None]:
    rows = bh.transitions(others, _STEP)
    learned = bh.PreyModel.fit(rows, given="speed", residual_of="constant_velocity")
    return {"counts": None, "table": bh.PreyModel.fit(rows), "constant_velocity": ConstantVelocity(),
            "conditioned": learned}  # fmt: skip


def _followed(body: bh.ForwardModel, run: Run, at: int, models: dict[str, TargetModel | None]) -> list[dict[str, Any]]:
    """A row a model: the walker of a run, from the same start."""
    path, bearing = run.places[:: run.stride], np.exp(1j * (at % 7))
    place = complex(path[0] + _FAR * bearing)
    start, rows = bh.Pose(place.real, place.imag, float(np.angle(-bearing))), []
    for name, known in models.items():
        caught, time, _ = _loop(body, path, start, known, 0.0)
        gaps = np.array(_loop(body, path, start, known, 0.5 * (_NEAR + _FAR))[2])
        company = float(((gaps >= _NEAR) & (gaps <= _FAR)).mean())
        rows.append({"model": name, "scene": run.scene, "id": at, "caught": caught, "time": time, "company": company})
    return rows


def follow(folder: Path, scenes: Sequence[str], walkers: int) -> dict[str, Any]:
    """The figures of each prey model, paired over walkers; models are learned from the files of the other scenes.

    scenes: ends of the names of the files whose walkers are followed.
    """
    tracks = {path.name: bh.read_tracks(path, 2.5, "m") for path in sorted(folder.glob("*.txt"))}
    held = [name for name in tracks if name.endswith(tuple(scenes))]
    if not held:
        raise InputError(f"{folder}: no .txt file whose name ends in {' or '.join(scenes)}; name one by --scene")
    body, rows = _body(), []
    for scene in held:
        models = _models(pd.concat([table for name, table in tracks.items() if name != scene]))
        long = [run for run in runs(tracks[scene], _STEP) if len(run.places) * _STEP / run.stride >= _LEAST]
        for at in np.random.default_rng(0).permutation(len(long))[: walkers // len(held)].tolist():
            rows += _followed(body, long[at], at, models)
    return {"models": summary(pd.DataFrame(rows)).to_dict("records")}


def report(facts: dict[str, Any]) -> str:
    """The figures as a Markdown table."""
    lines = ["| prey model | caught | mean time | company | less constant velocity: caught | time s | company |",
             "| --- | --- | --- | --- | --- | --- | --- |"]  # fmt: skip
    for row in facts["models"]:
        apart = [f"{row[f'{n}_differs']:+.3f} ({row[f'{n}_low']:+.3f} to {row[f'{n}_high']:+.3f})"
                 for n in ("caught", "time", "company")]  # fmt: skip
        caught = f"{row['caught']} of {row['n']} ({row['share_low']:.1%} to {row['share_high']:.1%})"
        cells = [row["model"], caught, f"{row['mean_time']:.2f} s", f"{row['company']:.1%}", *apart]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Run and print."""
    parser = command(__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scene", nargs="+", default=["zara01.txt", "zara02.txt"], help="ends of their files' names")
    parser.add_argument("--walkers", type=int, default=200)
    options = parser.parse_args()
    quiet_pgmpy()
    show(follow(options.folder, options.scene, options.walkers), report, options)


if __name__ == "__main__":
    main()
