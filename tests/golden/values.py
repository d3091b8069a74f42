"""What the golden file holds: one SHA-256 for every result that must stay as it is, made through public names alone.

Run as a script to print the hashes of this machine: ``python tests/golden/values.py``; with ``--write`` they replace
those in ``golden.json`` (only for a change of results that somebody has asked for, in a commit that says so). On a
processor with AVX-512 write them a second time as one without it would, with
``NPY_DISABLE_CPU_FEATURES="X86_V4 AVX512_ICL AVX512_SPR"``.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd

import bayeshunt as bh

FILE = Path(__file__).with_name("golden.json")
ROWS, SEEDS, ARENAS, THETA = 600, (3, 4), ("walled", "open"), 2.0
PLANNERS = (
    "reactive", "prediction", "planning", "pure_pursuit", "proportional_navigation", "constant_velocity", "omniscient",
    "frugal", "reference", "memory", "memory_place", "memory_previous", "intercept", "intercept_room",
    "intercept_walls", "belief", "detour",
)  # fmt: skip
STRUCTURES = ("naive", "tan", "joint", "previous_gait", "learned")

#: Columns of an episode when the golden file was made; later ones may come and change nothing.
COLUMNS = (
    "step", "time", "hunter_x", "hunter_y", "hunter_theta", "prey_x", "prey_y", "prey_theta", "seen_distance",
    "seen_angle", "seen_heading", "target_distance", "target_angle", "target_heading", "gait", "planned_gaits", "value",
    "objective", "nodes", "evidence_probability", "support", "posterior", "posterior_entropy", "prey_known",
    "prey_observations", "observed_distance", "observed_angle", "observed_heading", "expected_distance",
    "expected_angle", "expected_heading", "predicted_distance", "predicted_angle", "predicted_heading",
    "planned_distance", "planned_angle", "planned_heading", "alternative_gaits", "alternative_values", "prey_table",
)  # fmt: skip


def sha(value: Any) -> str:
    """SHA-256 of a table, an array, bytes, text or plain value: of its exact bits."""
    digest = hashlib.sha256()
    for part in parts(value):
        digest.update(part)
    return digest.hexdigest()


def parts(value: Any) -> Iterator[bytes]:
    """Yield the bytes that stand for a value, without regard to how a library stores it."""
    if isinstance(value, pd.DataFrame):
        for name in value.columns:
            yield str(name).encode()
            yield from parts(value[name].tolist())
    elif isinstance(value, (np.ndarray, pd.Series, np.generic)):
        yield from parts(value.tolist())
    elif isinstance(value, dict):
        for key in value:
            yield str(key).encode()
            yield from parts(value[key])
    elif isinstance(value, (list, tuple)):
        yield b"["
        for one in value:
            yield from parts(one)
    elif isinstance(value, bytes):
        yield value
    else:
        # repr of a float is exact; NaN and missing values are alike in every library's version
        yield b"-" if value is None or value is pd.NA or value != value else repr(value).encode()


@cache
def robot() -> Any:
    """The paper's robot."""
    return bh.load_robot("khepera")


@cache
def frame(name: str = "khepera") -> pd.DataFrame:
    """A babbling table."""
    return bh.babble(name, ROWS, 5)


@cache
def model(structure: str = "naive") -> Any:
    """A forward model of it."""
    prior = 0.0 if structure == "naive" else 0.03
    return bh.ForwardModel.fit(frame(), robot().gaits, prior, structure=structure)


def content(thing: Any) -> Any:
    """What a thing writes, without checksum, versions and where its rows came from."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "file.json"
        thing.save(path)
        whole = json.loads(path.read_text(encoding="utf-8"))
    inside = whole.get("content", whole.get("memory", whole))
    return {key: inside[key] for key in sorted(inside) if key not in ("provenance", "origin")}


@cache
def room(arena: str) -> Any:
    """What the robot learns of an arena by babbling there."""
    return bh.learn_room("paper", arena=arena, steps=200, seed=7, model=model())


@cache
def reference() -> Any:
    """A coarse reference table: exact values are not needed, the same ones are."""
    return bh.reference("paper", samples=2, angles=12, headings=12)


@cache
def memory() -> Any:
    """What earlier prey taught."""
    return bh.remember("paper", runs=1, seed=11, model=model())


def planner(name: str, arena: str, structure: str) -> Any:
    """A planner with its default settings and what it cannot do without."""
    given: dict[str, Any] = {}
    if name == "reference":
        given["table"] = reference()
    elif name.startswith("memory"):
        given["tables"] = memory()
    elif name in ("intercept_walls", "detour"):
        given["room"] = room(arena)
    return bh.make_planner(name, model(structure), **given)


def hunt(name: str, arena: str, seed: int, structure: str = "naive", robot: str = "khepera") -> Any:
    """The whole record of one hunt: every decision, every pose."""
    settings = bh.load_experiment("paper")
    if robot != "khepera":
        settings = settings.model_copy(update={"robot": bh.load_robot(robot)})
    chosen = planner(name, arena, structure) if robot == "khepera" else bh.make_planner(name, fitted(robot))
    episode = bh.hunt(settings, chosen, arena=arena, theta=THETA, seed=seed)
    record = episode.frame.reindex(columns=list(COLUMNS))
    return [record, episode.trail, episode.caught, episode.time]


def fitted(robot: str) -> Any:
    """The paper's network of another robot."""
    return bh.ForwardModel.fit(frame(robot), bh.load_robot(robot).gaits)


def tables(structure: str) -> Any:
    """Every table, count and interval of a model, and its answers all over the plane."""
    chosen = model(structure)
    inverse = bh.InverseModel(chosen)
    distances = np.linspace(0.0, 0.4, 23)
    angles = np.linspace(-3.1, 3.1, 23)
    return [
        [chosen.cpt(v) for v in ("Distance", "Angle", "Heading")],
        [chosen.counts(v) for v in ("Distance", "Angle", "Heading")],
        inverse.posterior_many(distances, angles),
        [[inverse.posterior(d, a).probabilities, inverse.posterior(d, a).evidence_probability]
         for d, a in zip(distances.tolist(), angles.tolist(), strict=True)],
    ]  # fmt: skip


def evaluation() -> Any:
    """The table of a small evaluation."""
    return bh.evaluate("paper", runs=1, seed=5, model=model()).reset_index(drop=True)


def entries() -> dict[str, Callable[[], Any]]:
    """Every entry of the golden file: its name, and what makes the value behind it."""
    made: dict[str, Callable[[], Any]] = {
        "babbling khepera": frame,
        "babbling car": partial(frame, "car"),
        "evaluation": evaluation,
        "reference": lambda: reference().values,
        "memory": lambda: content(memory()),
    }
    for arena in ARENAS:
        made[f"room {arena}"] = lambda arena=arena: content(room(arena))
    for structure in STRUCTURES:
        made[f"model file {structure}"] = lambda structure=structure: content(model(structure))
        made[f"tables {structure}"] = partial(tables, structure)
    for name in PLANNERS:
        for arena in ARENAS:
            for seed in SEEDS:
                made[f"hunt {name} {arena} {seed}"] = partial(hunt, name, arena, seed)
    for name in ("prediction", "planning", "intercept", "belief"):
        for structure in STRUCTURES[1:]:
            made[f"hunt {name} open 3 {structure}"] = partial(hunt, name, "open", 3, structure)
        made[f"hunt {name} walled 3 car"] = partial(hunt, name, "walled", 3, robot="car")
    return made


def processor() -> str:
    """The kind of processor: NumPy's sines differ in the last bit between those with and without AVX-512."""
    from numpy._core._multiarray_umath import __cpu_features__ as features

    return "avx512" if features.get("AVX512_SKX") else "other"


def main() -> None:
    """Print every hash, or write them."""
    found = {name: sha(make()) for name, make in entries().items()}
    if "--write" in sys.argv:
        kept = json.loads(FILE.read_text()) if FILE.exists() else {}
        FILE.write_text(json.dumps({**kept, processor(): found}, indent=1, sort_keys=True) + "\n")
    else:
        print("\n".join(f"{value}  {name}" for name, value in found.items()))


if __name__ == "__main__":
    main()
