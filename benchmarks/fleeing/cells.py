"""Which prey there are and which hunters meet them: hunts of each pair, kept so that a second run adds only more."""

from __future__ import annotations

import json
from dataclasses import dataclass
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

__all__ = ["HUNTERS", "PREYS", "Prey", "cell", "weights"]

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

    hunter: whom it learned to flee; "": it has not learned. steps: of training. after: the prey that it went on from.
    changes: settings of one that ships.
    """

    name: str
    arena: str = "open"
    hunter: str = ""
    steps: int = 0
    seed: int = 0
    after: str = ""
    changes: tuple[tuple[str, Any], ...] = ()

    @property
    def file(self) -> Path:
        """Where its weights are."""
        return FOLDER / f"{self.name}.npz"

    @property
    def settings(self) -> ExperimentSettings:
        """The experiment that it lives in."""
        return load_experiment(PRESET, dict(self.changes))


_FIRST, _MORE = "planning_open", 20_000
PREYS = (
    Prey("paper_open", "open"),
    Prey("evader_open", "open", changes=(("prey.behaviour", "evader"),)),
    Prey("senses_open", "open", changes=(("prey.senses_hunter", True),)),
    Prey(_FIRST, "open", "planning", 100_000),
    *(Prey(f"{hunter}_open", "open", hunter, _MORE, after=_FIRST) for hunter in HUNTERS[1:5]),
    Prey("paper_walled", "walled"),
    Prey("evader_walled", "walled", changes=(("prey.behaviour", "evader"),)),
    Prey("senses_walled", "walled", changes=(("prey.senses_hunter", True),)),
    Prey("planning_walled", "walled", "planning", 50_000),
)


def prepared(settings: ExperimentSettings, name: str, arena: str, seed: int, model: ForwardModel) -> Planner:
    """Return a hunter that is ready for an arena."""
    return prepare_planner(name, model, settings, learn_rooms(settings, [name], [arena], seed, model), arena)


def weights(prey: Prey) -> PreyPolicy:
    """Return what a prey learned: from its file, or learned now."""
    if not prey.file.exists():
        from benchmarks.fleeing.training import train

        start = weights(next(one for one in PREYS if one.name == prey.after)) if prey.after else None
        model = learn_model(prey.settings, _TRAINING_SEED + prey.seed)
        planner = prepared(prey.settings, prey.hunter, prey.arena, _TRAINING_SEED + prey.seed, model)
        train(planner, prey.arena, prey.steps, prey.seed, start, preset=PRESET).save(prey.file)
    return PreyPolicy.load(prey.file)


def cell(prey: Prey, hunter: str, seed: int, runs: int, folder: Path) -> list[tuple[float, bool]] | None:
    """Return (time, caught) of ``runs`` hunts per bearing; None for a pair that cannot be.

    seed: of the evaluation; the hunter babbles with it. Hunts in ``folder`` are not hunted again.
    """
    if hunter == KNOWING and not prey.hunter:
        return None
    path = folder / f"{prey.name}-{hunter}-{seed}.json".replace(" ", "_")
    kept = json.loads(path.read_text()) if path.exists() else []
    if len(kept) < runs:
        kept += _hunted(prey, hunter, seed, range(len(kept), runs))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(kept) + "\n")
    return [(time, caught) for run in kept[:runs] for time, caught in run]


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
