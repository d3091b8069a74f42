"""Options and checks that several commands share."""

from __future__ import annotations

import contextlib
import json
import shlex
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.core.errors import InputError, did_you_mean

__all__ = [
    "Arenas",
    "Config",
    "Jobs",
    "Json",
    "Model",
    "Overrides",
    "Planners",
    "Preset",
    "Quiet",
    "Runs",
    "Seed",
    "asked_backoff",
    "check_names",
    "complete_arena",
    "complete_planner",
    "complete_preset",
    "complete_robot",
    "complete_structure",
    "count_hunts",
    "evaluate_words",
    "gaits_of",
    "load_or_learn",
    "parse_overrides",
    "read_experiment",
    "say_chosen",
    "settings_of",
    "tell",
    "toml_value",
]


def asked_backoff(rows: float | None) -> Any:
    """Return what ``--backoff`` says as the models take it: nothing is their default, 0 is none."""
    return "auto" if rows is None else rows or None


def complete_planner(incomplete: str) -> list[str]:
    """Return the planners that a word on the command line may become."""
    from bayeshunt.planners.registry import planner_names

    return [name for name in planner_names() if name.startswith(incomplete)]


def complete_robot(incomplete: str) -> list[str]:
    """Return the robots that ship and that a word on the command line may become."""
    from bayeshunt.config.loading import preset_names

    return [name for name in preset_names("robots") if name.startswith(incomplete)]


def complete_preset(incomplete: str) -> list[str]:
    """Return the experiments that ship and that a word on the command line may become."""
    from bayeshunt.config.loading import preset_names

    return [name for name in preset_names() if name.startswith(incomplete)]


def complete_arena(incomplete: str) -> list[str]:
    """Return the arenas of the experiments that ship that a word on the command line may become."""
    from bayeshunt.config.loading import load_experiment, preset_names

    arenas = dict.fromkeys(arena for preset in preset_names() for arena in load_experiment(preset).arenas)
    return [name for name in arenas if name.startswith(incomplete)]


def complete_structure(incomplete: str) -> list[str]:
    """Return the structures that ship and that a word on the command line may become."""
    from bayeshunt.models.tables.structures import STRUCTURES

    return [name for name in STRUCTURES if name.startswith(incomplete)]


Json = Annotated[bool, typer.Option("--json", help="Print JSON for machines instead of text.")]
Seed = Annotated[int, typer.Option(help="One seed, one result, bit for bit.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress bar.")]
Preset = Annotated[
    str | None,
    typer.Option(
        help="Experiment settings that ship, by name (default: oses2010; with --model: those of its robot).",
        autocompletion=complete_preset,
    ),
]
Config = Annotated[
    Path | None,
    typer.Option(help='Your own experiment settings: a TOML file (may start with base = "paper").'),
]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", help="Change one setting, e.g. prey.speed=0.04; may be given several times."),
]
Planners = Annotated[
    list[str] | None, typer.Option(help="Planner; may be given several times.", autocompletion=complete_planner)
]
Arenas = Annotated[
    list[str] | None, typer.Option(help="Arena; may be given several times.", autocompletion=complete_arena)
]
Runs = Annotated[int | None, typer.Option(help="Runs per bearing; the settings' by default.")]
Jobs = Annotated[int, typer.Option(help="Worker processes; -1 for one per core.")]
Model = Annotated[
    Path | None,
    typer.Option(help="Model made by fit, or a network (.xmlbif, .bif); by default one is babbled and fitted."),
]


def tell(facts: dict[str, Any], as_json: bool, text: str) -> None:
    typer.echo(json.dumps(facts) if as_json else text)


def read_experiment(
    preset: str | None, config: Path | None, overrides: list[str] | None, model: Path | None = None
) -> Any:
    """Return the experiment that ``--preset``, ``--config`` and ``--set`` ask for.

    model: a model whose robot decides where neither preset nor settings are named; :func:`say_chosen` says so.
    """
    from bayeshunt.config.loading import DEFAULT_PRESET, load_experiment
    from bayeshunt.experiments.preparation import check_planners

    changes = parse_overrides(overrides)
    if model is not None and not (preset or config):
        settings = _experiment_of(model, changes)
    else:
        settings = load_experiment(config or preset or DEFAULT_PRESET, changes)
    check_planners(settings, ())
    return settings


def _experiment_of(path: Path, changes: dict[str, Any]) -> Any:
    """The shipped experiment, ``changes`` made, whose robot a model is of; the default, then the testbed come first."""
    from bayeshunt.config.loading import DEFAULT_PRESET, load_experiment, load_robot, preset_names
    from bayeshunt.experiments.preparation import check_model
    from bayeshunt.models.formats.interchange import open_model

    for name in sorted(preset_names(), key=lambda name: (name != DEFAULT_PRESET, name != "paper")):
        settings = load_experiment(name, changes)
        forward = open_model(path, settings.robot.gaits)
        with contextlib.suppress(InputError):
            check_model(forward, settings)
            return settings
    names = forward.gaits.names
    near = next((name for name in preset_names("robots") if load_robot(name).gaits.names == names), None)
    hint = "" if near is None else f", as robot {near} has: --set robot={near}"
    raise InputError(
        f"{path}: no preset has the robot that this model is of (gaits {', '.join(names)}{hint}); "
        "say the experiment with --preset or --config"
    )


def evaluate_words(preset: str | None, config: Path | None, overrides: list[str] | None = None) -> str:
    """The start of an evaluate line that runs the experiment of this command, with its robot in its arenas."""
    words = ["bayeshunt", "evaluate"]
    if config is not None:
        words += ["--config", str(config)]
    elif preset is not None:
        words += ["--preset", preset]
    for change in overrides or ():
        if change.split("=")[0].split(".")[0].strip() in ("robot", "world", "arenas"):
            words += ["--set", change]
    return shlex.join(words)


def say_chosen(settings: Any, preset: str | None, config: Path | None, model: Path | None) -> None:
    """Print, under a result, which preset a model's robot has decided on, if it has."""
    from bayeshunt.views.terminal import terminal

    if model is not None and not (preset or config):
        terminal.remark(f"Preset {settings.name!r}, because {model} is a model of its robot, {settings.robot.name!r}.")


def count_hunts(settings: Any, planners: Sequence[str], arenas: Sequence[str] | None) -> int:
    """Return how many hunts an evaluation has; arenas None: the settings'."""
    protocol = settings.protocol
    found: int = len(protocol.thetas) * protocol.runs * len(planners) * len(arenas or settings.arenas)
    return found


def parse_overrides(given: list[str] | None) -> dict[str, Any]:
    """Return ``KEY=VALUE`` options as settings by dotted key; a value is TOML, or else taken as text."""
    values: dict[str, Any] = {}
    for text in given or ():
        key, equals, value = text.partition("=")
        if not (key.strip() and equals):
            raise InputError(f"--set {text}: expected KEY=VALUE, for example --set prey.speed=0.04")
        values[key.strip()] = toml_value(value.strip())
    return values


def toml_value(text: str) -> Any:
    """Return ``text`` read as a TOML value (number, true, "text", [list]), or as it is if it is none."""
    import tomllib

    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def check_names(
    settings: Any, planners: list[str] | None, arenas: list[str] | None, *, hunting: bool = False
) -> list[str]:
    """Return the planners to run; InputError for an unknown planner or arena, before any work.

    hunting: whether they must be planners that hunt, so that bounds are refused too.
    """
    from bayeshunt.experiments.preparation import check_planners

    chosen = list(planners or settings.planners)
    check_planners(settings, chosen, hunting=hunting)
    for name in arenas or ():
        if name not in settings.arenas:
            raise InputError(f"unknown arena {name!r}{did_you_mean(name, settings.arenas)}")
    return chosen


def settings_of(hunts: Any, folder: Any) -> Any:
    """Return the settings that the results in a folder were made with."""
    from bayeshunt.config.loading import parse
    from bayeshunt.config.schema import ExperimentSettings

    return parse(ExperimentSettings, hunts.attrs["settings"], f"{folder}: settings")


def gaits_of(robot: str, records: Iterable[Any]) -> Any:
    """Return the gaits of a robot by name or path; warn if tables of these records are of one that moves otherwise."""
    from bayeshunt.config.loading import load_robot
    from bayeshunt.config.plausibility import warn_of_other_motion

    settings = load_robot(robot)
    for record in records:
        warn_of_other_motion(record, settings, "table")
    return settings.gaits


def load_or_learn(path: Path | None, settings: Any, seed: int, *, quiet: bool) -> Any:
    """Load the model, or babble, with a progress bar unless ``quiet``, and fit one."""
    from bayeshunt.experiments.preparation import check_model
    from bayeshunt.experiments.protocol import learn_model
    from bayeshunt.models.formats.interchange import open_model
    from bayeshunt.views.terminal import terminal

    if path is None:
        with terminal.progress_bar("babbling", settings.model.babbling_steps, quiet=quiet) as advance:
            return learn_model(settings, seed, advance)
    model = open_model(path, settings.robot.gaits)
    check_model(model, settings)
    return model
