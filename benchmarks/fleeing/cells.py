"""Which prey there are and which hunters meet them: a row of the table for each pair, made once."""

from __future__ import annotations

import csv
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.experiments.preparation import learn_rooms, prepare_planner
from bayeshunt.experiments.protocol import hunt_seed, learn_model
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Planner
from benchmarks.fleeing.knowing import Knowing
from benchmarks.fleeing.policy import PreyEnv, PreyPolicy, hunt

__all__ = ["HUNTERS", "PREYS", "Cell", "Prey", "cell", "learn", "read", "weights"]

PRESET = "paper"
#: Hunters of the table; the last is told the policy.
KNOWING = Knowing.name
HUNTERS = ("planning", "intercept", "intercept_walls", "search", "intercept_evader", KNOWING)
#: Of hunters that prey learn from: far from the seeds of results.
_TRAINING_SEED = 1000
FOLDER = Path(__file__).parent / "preys"


@dataclass(frozen=True)
class Prey:
    """A prey of the table: one that learned, or one that ships.

    hunter: whom it learned to flee; "": it has not learned. steps: of training. seed: of training.
    changes: settings of one that ships.
    """

    name: str
    arena: str = "open"
    hunter: str = ""
    steps: int = 0
    seed: int = 0
    changes: tuple[tuple[str, Any], ...] = ()

    @property
    def file(self) -> Path:
        """Where its weights are."""
        return FOLDER / f"{self.name}.npz"

    @property
    def settings(self) -> ExperimentSettings:
        """The experiment that it lives in."""
        return load_experiment(PRESET, dict(self.changes))


#: Gaits of the hunter that a prey learns in, and how often it learns anew.
_STEPS, _SEEDS = 300_000, 3
PREYS = (
    *(
        prey
        for arena in ("open", "walled")
        for prey in (
            Prey(f"paper_{arena}", arena),
            Prey(f"evader_{arena}", arena, changes=(("prey.behaviour", "evader"),)),
            Prey(f"senses_{arena}", arena, changes=(("prey.senses_hunter", True),)),
            *(
                Prey(f"{hunter}_{arena}_{seed}", arena, hunter, _STEPS, seed)
                for hunter in HUNTERS[:4]
                for seed in range(_SEEDS)
            ),
        )
    ),
    # from a prey that had learned from `planning` in 100,000 steps
    Prey("intercept_evader_open", "open", "intercept_evader", 20_000),
)


@dataclass(frozen=True)
class Cell:
    """A row of the table: one hunter against one prey, in the hunts of one evaluation seed.

    learned_from, training_seed, steps: of the prey; "" and 0 where it has not learned. hunts: of all bearings.
    time_s, square_s2: sums over the hunts of their times and squares, a miss with the time limit.
    """

    prey: str
    arena: str
    learned_from: str
    training_seed: int
    steps: int
    hunter: str
    evaluation_seed: int
    hunts: int
    caught: int
    time_s: float
    square_s2: float


def prepared(settings: ExperimentSettings, name: str, arena: str, seed: int, model: ForwardModel) -> Planner:
    """Return a hunter that is ready for an arena."""
    return prepare_planner(name, model, settings, learn_rooms(settings, [name], [arena], seed, model), arena)


def weights(prey: Prey) -> PreyPolicy:
    """Return what a prey learned; InputError if there is no file of it."""
    return PreyPolicy.load(prey.file)


def learn(prey: Prey) -> None:
    """Let a prey learn, and write its file."""
    from benchmarks.fleeing.training import train

    seed = _TRAINING_SEED + prey.seed
    planner = prepared(prey.settings, prey.hunter, prey.arena, seed, learn_model(prey.settings, seed))
    train(planner, prey.arena, prey.steps, prey.seed, preset=PRESET).save(prey.file)


def read(table: Path) -> list[Cell]:
    """Return the rows of a table; none where there is no file."""
    if not table.exists():
        return []
    with table.open(newline="", encoding="utf-8") as file:
        kinds = {field.name: {"int": int, "float": float}.get(str(field.type), str) for field in fields(Cell)}
        return [Cell(**{name: kinds[name](text) for name, text in row.items()}) for row in csv.DictReader(file)]


def cell(prey: Prey, hunter: str, seed: int, runs: int, table: Path) -> Cell | None:
    """Return the row of ``runs`` hunts per bearing; None for a pair that cannot be.

    seed: of the evaluation; the hunter babbles with it. A row of ``table`` with so many hunts or more is taken as it
    is; else it is made, and put into the table.
    """
    if hunter == KNOWING and not prey.hunter:
        return None
    rows, key = read(table), (prey.name, hunter, seed)
    kept = {(row.prey, row.hunter, row.evaluation_seed): row for row in rows}
    if key in kept and kept[key].hunts >= runs * len(prey.settings.protocol.thetas):
        return kept[key]
    ends = [end for run in _hunted(prey, hunter, seed, range(runs)) for end in run]
    times = [time for time, _ in ends]
    kept[key] = Cell(
        prey.name, prey.arena, prey.hunter, prey.seed, prey.steps, hunter, seed, len(ends),
        sum(caught for _, caught in ends), round(sum(times), 6), round(sum(time * time for time in times), 6),
    )  # fmt: skip
    _write(list(kept.values()), table)
    return kept[key]


def _write(rows: list[Cell], table: Path) -> None:
    """Write a table, its rows in the order of the prey and of the hunters."""
    order = [prey.name for prey in PREYS]
    rows = sorted(rows, key=lambda row: (order.index(row.prey), HUNTERS.index(row.hunter), row.evaluation_seed))
    table.parent.mkdir(parents=True, exist_ok=True)
    with table.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Cell)], lineterminator="\n")
        writer.writeheader()
        writer.writerows(map(asdict, rows))


def _hunted(prey: Prey, hunter: str, seed: int, runs: range) -> list[list[tuple[float, bool]]]:
    settings, thetas = prey.settings, prey.settings.protocol.thetas
    model = learn_model(settings, seed)
    policy = weights(prey) if prey.hunter else None
    if policy is None:
        planner = prepared(settings, hunter, prey.arena, seed, model)

        def once(theta: float, number: int) -> tuple[float, bool]:
            result = run_hunt(settings, planner, prey.arena, theta, number)
            return result.time, result.caught
    else:
        knowing = Knowing(model, policy, settings, prey.arena) if hunter == KNOWING else None
        planner = prepared(settings, hunter, prey.arena, seed, model) if knowing is None else knowing
        env = PreyEnv(planner, prey.arena, preset=PRESET)
        if knowing is not None:
            knowing.hunt = env.hunt

        def once(theta: float, number: int) -> tuple[float, bool]:
            return hunt(env, policy, theta, number)

    return [[once(theta, hunt_seed(seed, index, run)) for index, theta in enumerate(thetas)] for run in runs]
