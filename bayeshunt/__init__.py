"""bayeshunt: a robot that learns what its body can do and how its prey moves, and hunts by asking tables.

The public names below are loaded when first used, so that ``import bayeshunt`` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from bayeshunt import displays

if TYPE_CHECKING:
    from bayeshunt.axes import Axis, EffectAxes
    from bayeshunt.config import ExperimentSettings, RobotSettings
    from bayeshunt.dataset import load as load_dataset
    from bayeshunt.dataset import save as save_dataset
    from bayeshunt.episode import Episode
    from bayeshunt.errors import (
        BayesHuntError,
        ConfigError,
        DataError,
        FolderInUseError,
        ImpossibleEvidenceError,
        InputError,
        ModelFileError,
        NothingObservedError,
        ResultsError,
        WorkerError,
        ZeroCountError,
    )
    from bayeshunt.experiments.explorations import learn_room
    from bayeshunt.experiments.memories import remember
    from bayeshunt.experiments.references import reference
    from bayeshunt.experiments.runner import evaluate
    from bayeshunt.experiments.scores import summarise, wilson_interval
    from bayeshunt.experiments.store import load_results, save_results
    from bayeshunt.experiments.sweep import sweep
    from bayeshunt.experiments.tradeoff import tradeoff
    from bayeshunt.gaits import Gait, GaitRepertoire
    from bayeshunt.geometry import Polar, Pose, wrap
    from bayeshunt.hunting import hunt
    from bayeshunt.models.assess import Assessment, assess
    from bayeshunt.models.forward import ForwardModel
    from bayeshunt.models.interchange import read_network as import_network
    from bayeshunt.models.inverse import InverseModel
    from bayeshunt.models.prey import PreyModel
    from bayeshunt.models.rooms import RoomModel
    from bayeshunt.models.structures import Structure
    from bayeshunt.models.turns import TurnModel
    from bayeshunt.planners.base import Plan, Situation
    from bayeshunt.planners.catalogue import describe_planner
    from bayeshunt.planners.registry import make_planner, planner_names, register_planner
    from bayeshunt.settings import load_experiment, load_robot
    from bayeshunt.views.explorer import Explorer
    from bayeshunt.views.replay import write_replay
    from bayeshunt.views.report import write_report
    from bayeshunt.world.babbling import babble
    from bayeshunt.world.prey import register_prey

#: Public name -> (module, name there).
_HOMES = {
    **{name: ("bayeshunt.axes", name) for name in ("Axis", "EffectAxes")},
    **{name: ("bayeshunt.config", name) for name in ("ExperimentSettings", "RobotSettings")},
    "load_dataset": ("bayeshunt.dataset", "load"),
    "save_dataset": ("bayeshunt.dataset", "save"),
    "Episode": ("bayeshunt.episode", "Episode"),
    **{
        name: ("bayeshunt.errors", name)
        for name in (
            "BayesHuntError",
            "ConfigError",
            "DataError",
            "FolderInUseError",
            "ImpossibleEvidenceError",
            "InputError",
            "ModelFileError",
            "NothingObservedError",
            "ResultsError",
            "WorkerError",
            "ZeroCountError",
        )
    },
    "evaluate": ("bayeshunt.experiments.runner", "evaluate"),
    "reference": ("bayeshunt.experiments.references", "reference"),
    "learn_room": ("bayeshunt.experiments.explorations", "learn_room"),
    "RoomModel": ("bayeshunt.models.rooms", "RoomModel"),
    "TurnModel": ("bayeshunt.models.turns", "TurnModel"),
    "remember": ("bayeshunt.experiments.memories", "remember"),
    "sweep": ("bayeshunt.experiments.sweep", "sweep"),
    "tradeoff": ("bayeshunt.experiments.tradeoff", "tradeoff"),
    **{name: ("bayeshunt.experiments.scores", name) for name in ("summarise", "wilson_interval")},
    **{name: ("bayeshunt.experiments.store", name) for name in ("load_results", "save_results")},
    **{name: ("bayeshunt.gaits", name) for name in ("Gait", "GaitRepertoire")},
    **{name: ("bayeshunt.geometry", name) for name in ("Polar", "Pose", "wrap")},
    **{name: ("bayeshunt.models.assess", name) for name in ("Assessment", "assess")},
    "ForwardModel": ("bayeshunt.models.forward", "ForwardModel"),
    "import_network": ("bayeshunt.models.interchange", "read_network"),
    "InverseModel": ("bayeshunt.models.inverse", "InverseModel"),
    "Structure": ("bayeshunt.models.structures", "Structure"),
    "PreyModel": ("bayeshunt.models.prey", "PreyModel"),
    **{name: ("bayeshunt.planners.base", name) for name in ("Plan", "Situation")},
    "describe_planner": ("bayeshunt.planners.catalogue", "describe_planner"),
    **{name: ("bayeshunt.planners.registry", name) for name in ("make_planner", "planner_names", "register_planner")},
    **{name: ("bayeshunt.settings", name) for name in ("load_experiment", "load_robot")},
    "babble": ("bayeshunt.world.babbling", "babble"),
    "register_prey": ("bayeshunt.world.prey", "register_prey"),
    "hunt": ("bayeshunt.hunting", "hunt"),
    "Explorer": ("bayeshunt.views.explorer", "Explorer"),
    "write_replay": ("bayeshunt.views.replay", "write_replay"),
    "write_report": ("bayeshunt.views.report", "write_report"),
}

# Models, plans and episodes show themselves; only the package knows which room draws them.
displays.arrange("bayeshunt.views.display")

__all__ = ["__version__", *sorted(_HOMES)]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("bayeshunt")
    if name not in _HOMES:
        raise AttributeError(f"module 'bayeshunt' has no attribute {name!r}")
    home, attribute = _HOMES[name]
    value = getattr(import_module(home), attribute)
    globals()[name] = value  # found once, then an ordinary attribute
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
