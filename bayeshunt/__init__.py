"""bayeshunt: a robot that learns what its body can do and how its prey moves, and hunts by asking tables.

The public names below are loaded when first used, so that ``import bayeshunt`` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from bayeshunt.core import displays

if TYPE_CHECKING:
    from bayeshunt import protocols
    from bayeshunt.config.loading import load_experiment, load_robot
    from bayeshunt.config.schema import DriveSettings, ExperimentSettings, RobotSettings
    from bayeshunt.core.bins import Axis, EffectAxes
    from bayeshunt.core.errors import (
        BayesHuntError,
        ConfigError,
        DataError,
        DataWarning,
        FolderInUseError,
        ImpossibleEvidenceError,
        InputError,
        ModelFileError,
        NothingObservedError,
        ResultsError,
        WorkerError,
        ZeroCountError,
    )
    from bayeshunt.core.gaits import Gait, GaitRepertoire
    from bayeshunt.core.geometry import Polar, Pose, wrap
    from bayeshunt.core.task import Task
    from bayeshunt.data.babbling_table import load as load_dataset
    from bayeshunt.data.babbling_table import save_dataset
    from bayeshunt.data.logs import read_log
    from bayeshunt.data.readers.registry import register_reader
    from bayeshunt.data.segmenting import gaits_from_log, gaits_from_windows
    from bayeshunt.data.track_report import track_report
    from bayeshunt.data.tracks import read_tracks, tracks
    from bayeshunt.data.transitions import transitions
    from bayeshunt.episodes.episode import Episode
    from bayeshunt.episodes.hunter import Hunter
    from bayeshunt.episodes.loop import hunt
    from bayeshunt.episodes.pursuit import Pursuit
    from bayeshunt.episodes.tracing import trace
    from bayeshunt.experiments.preparation import learn_room
    from bayeshunt.experiments.run.runner import evaluate
    from bayeshunt.experiments.scores import summarise, wilson_interval
    from bayeshunt.experiments.store.export import load_results, save_results
    from bayeshunt.experiments.studies.memories import remember
    from bayeshunt.experiments.studies.references import reference
    from bayeshunt.experiments.studies.routes import routes
    from bayeshunt.experiments.studies.sweep import sweep
    from bayeshunt.experiments.studies.tradeoff import tradeoff
    from bayeshunt.models.arena.free_space import FreeSpace
    from bayeshunt.models.arena.rooms import RoomModel
    from bayeshunt.models.assessment.assess import Assessment, assess
    from bayeshunt.models.assessment.forward_scores import score_forward
    from bayeshunt.models.assessment.prey_scores import score_prey
    from bayeshunt.models.body.forward import ForwardModel
    from bayeshunt.models.body.inverse import InverseModel
    from bayeshunt.models.comparison.compare import compare
    from bayeshunt.models.comparison.learning import Learning
    from bayeshunt.models.formats.interchange import read_network as import_network
    from bayeshunt.models.inference.network import Network
    from bayeshunt.models.tables.structures import Structure
    from bayeshunt.models.target.conformance import check_prey_model
    from bayeshunt.models.target.prey import PreyModel
    from bayeshunt.models.target.registry import register_prey_model
    from bayeshunt.models.target.turns import TurnModel
    from bayeshunt.perception.conformance import check_sensor, check_tracker
    from bayeshunt.perception.registry import register_sensor, register_tracker
    from bayeshunt.planners.api import Plan, Situation
    from bayeshunt.planners.catalogue import describe_planner
    from bayeshunt.planners.conformance import check_planner
    from bayeshunt.planners.info import PlannerInfo
    from bayeshunt.planners.policy import planner_policy, policy_planner
    from bayeshunt.planners.registry import make_planner, planner_names, register_planner
    from bayeshunt.views.notebook.explorer import Explorer
    from bayeshunt.views.pages.maps import write_map
    from bayeshunt.views.pages.replay import write_replay
    from bayeshunt.views.pages.report import write_report
    from bayeshunt.worlds.babbling import babble
    from bayeshunt.worlds.bodies import register_body
    from bayeshunt.worlds.box2d.bodies import Drive
    from bayeshunt.worlds.conformance import check_body, check_prey, check_world
    from bayeshunt.worlds.live import Babbler
    from bayeshunt.worlds.prey.behaviours import register_prey
    from bayeshunt.worlds.registry import register_world

#: Public name -> (module, name there).
_HOMES = {
    **{name: ("bayeshunt.core.bins", name) for name in ("Axis", "EffectAxes")},
    **{name: ("bayeshunt.config.schema", name) for name in ("ExperimentSettings", "RobotSettings")},
    "load_dataset": ("bayeshunt.data.babbling_table", "load"),
    "save_dataset": ("bayeshunt.data.babbling_table", "save_dataset"),
    **{name: ("bayeshunt.data.tracks", name) for name in ("read_tracks", "tracks")},
    "read_log": ("bayeshunt.data.logs", "read_log"),
    **{name: ("bayeshunt.data.segmenting", name) for name in ("gaits_from_log", "gaits_from_windows")},
    "score_forward": ("bayeshunt.models.assessment.forward_scores", "score_forward"),
    "score_prey": ("bayeshunt.models.assessment.prey_scores", "score_prey"),
    "register_reader": ("bayeshunt.data.readers.registry", "register_reader"),
    "track_report": ("bayeshunt.data.track_report", "track_report"),
    "transitions": ("bayeshunt.data.transitions", "transitions"),
    "Episode": ("bayeshunt.episodes.episode", "Episode"),
    **{
        name: ("bayeshunt.core.errors", name)
        for name in (
            "BayesHuntError",
            "ConfigError",
            "DataError",
            "DataWarning",
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
    "evaluate": ("bayeshunt.experiments.run.runner", "evaluate"),
    "reference": ("bayeshunt.experiments.studies.references", "reference"),
    "learn_room": ("bayeshunt.experiments.preparation", "learn_room"),
    "RoomModel": ("bayeshunt.models.arena.rooms", "RoomModel"),
    "FreeSpace": ("bayeshunt.models.arena.free_space", "FreeSpace"),
    "TurnModel": ("bayeshunt.models.target.turns", "TurnModel"),
    "remember": ("bayeshunt.experiments.studies.memories", "remember"),
    "sweep": ("bayeshunt.experiments.studies.sweep", "sweep"),
    "routes": ("bayeshunt.experiments.studies.routes", "routes"),
    "tradeoff": ("bayeshunt.experiments.studies.tradeoff", "tradeoff"),
    **{name: ("bayeshunt.experiments.scores", name) for name in ("summarise", "wilson_interval")},
    **{name: ("bayeshunt.experiments.store.export", name) for name in ("load_results", "save_results")},
    **{name: ("bayeshunt.core.gaits", name) for name in ("Gait", "GaitRepertoire")},
    **{name: ("bayeshunt.core.geometry", name) for name in ("Polar", "Pose", "wrap")},
    "Task": ("bayeshunt.core.task", "Task"),
    **{name: ("bayeshunt.models.assessment.assess", name) for name in ("Assessment", "assess")},
    "ForwardModel": ("bayeshunt.models.body.forward", "ForwardModel"),
    "import_network": ("bayeshunt.models.formats.interchange", "read_network"),
    "InverseModel": ("bayeshunt.models.body.inverse", "InverseModel"),
    "compare": ("bayeshunt.models.comparison.compare", "compare"),
    "Learning": ("bayeshunt.models.comparison.learning", "Learning"),
    "trace": ("bayeshunt.episodes.tracing", "trace"),
    "Network": ("bayeshunt.models.inference.network", "Network"),
    "Structure": ("bayeshunt.models.tables.structures", "Structure"),
    "PreyModel": ("bayeshunt.models.target.prey", "PreyModel"),
    **{name: ("bayeshunt.planners.api", name) for name in ("Plan", "Situation")},
    "check_planner": ("bayeshunt.planners.conformance", "check_planner"),
    "PlannerInfo": ("bayeshunt.planners.info", "PlannerInfo"),
    "describe_planner": ("bayeshunt.planners.catalogue", "describe_planner"),
    **{name: ("bayeshunt.planners.registry", name) for name in ("make_planner", "planner_names", "register_planner")},
    **{name: ("bayeshunt.config.loading", name) for name in ("load_experiment", "load_robot")},
    "babble": ("bayeshunt.worlds.babbling", "babble"),
    "register_prey": ("bayeshunt.worlds.prey.behaviours", "register_prey"),
    "register_body": ("bayeshunt.worlds.bodies", "register_body"),
    "Drive": ("bayeshunt.worlds.box2d.bodies", "Drive"),
    "DriveSettings": ("bayeshunt.config.schema", "DriveSettings"),
    "register_world": ("bayeshunt.worlds.registry", "register_world"),
    **{name: ("bayeshunt.perception.registry", name) for name in ("register_sensor", "register_tracker")},
    "register_prey_model": ("bayeshunt.models.target.registry", "register_prey_model"),
    "Babbler": ("bayeshunt.worlds.live", "Babbler"),
    **{name: ("bayeshunt.worlds.conformance", name) for name in ("check_body", "check_prey", "check_world")},
    **{name: ("bayeshunt.perception.conformance", name) for name in ("check_sensor", "check_tracker")},
    "check_prey_model": ("bayeshunt.models.target.conformance", "check_prey_model"),
    "Hunter": ("bayeshunt.episodes.hunter", "Hunter"),
    "hunt": ("bayeshunt.episodes.loop", "hunt"),
    "Pursuit": ("bayeshunt.episodes.pursuit", "Pursuit"),
    **{name: ("bayeshunt.planners.policy", name) for name in ("planner_policy", "policy_planner")},
    "Explorer": ("bayeshunt.views.notebook.explorer", "Explorer"),
    "write_map": ("bayeshunt.views.pages.maps", "write_map"),
    "write_replay": ("bayeshunt.views.pages.replay", "write_replay"),
    "write_report": ("bayeshunt.views.pages.report", "write_report"),
}

# Models, plans and episodes show themselves; only the package knows which room draws them.
displays.arrange("bayeshunt.views.notebook.display")

__all__ = ["__version__", "protocols", *sorted(_HOMES)]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("bayeshunt")
    if name == "protocols":
        return import_module("bayeshunt.protocols")
    if name not in _HOMES:
        raise AttributeError(f"module 'bayeshunt' has no attribute {name!r}")
    home, attribute = _HOMES[name]
    value = getattr(import_module(home), attribute)
    globals()[name] = value  # found once, then an ordinary attribute
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
