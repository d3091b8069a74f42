"""The command lines that make a hunt or an evaluation again, and the settings file they need."""

from __future__ import annotations

import json
import os
import re
import shlex
from collections.abc import Iterator, Sequence
from typing import Any

from bayeshunt.config.loading import load_experiment, preset_names
from bayeshunt.config.schema import ExperimentSettings

__all__ = ["SETTINGS_FILE", "evaluate_command", "hunt_command", "model_option", "preset_of", "to_toml"]

#: What the settings file is called in the commands, where no preset has these settings.
SETTINGS_FILE = "settings.toml"


def preset_of(settings: ExperimentSettings) -> str | None:
    """Return the name of the preset with exactly these settings (runs per bearing aside), or None."""
    for name in preset_names():
        preset = load_experiment(name, {"protocol.runs": settings.protocol.runs})
        if preset == settings:
            return name
    return None


def hunt_command(
    settings: ExperimentSettings, planner: str, arena: str, theta: float, seed: int, *, source: Sequence[str] = ()
) -> str:
    """Return the command that makes one hunt and its replay again; ``source`` as :func:`model_option` gives it."""
    words = ["bayeshunt", "hunt", *_experiment(settings), "--planner", planner, "--arena", arena]
    words += ["--theta", f"{float(theta)!r}", "--seed", str(seed), *source, "--replay", "hunt.html"]
    return shlex.join(words)


def model_option(model: str | os.PathLike[str] | None, babbling_seed: int = 0) -> list[str]:
    """Return the options that give ``bayeshunt hunt`` its model: a file, or the seed it is babbled with."""
    if model is not None:
        return ["--model", os.fspath(model)]
    return ["--babbling-seed", str(babbling_seed)] if babbling_seed else []


def evaluate_command(
    settings: ExperimentSettings, planners: Sequence[str], arenas: Sequence[str], seed: int, *, model: str | None = None
) -> str:
    """Return the command that makes an evaluation again; ``model`` is the path of the model file if one was used."""
    words = ["bayeshunt", "evaluate", *_experiment(settings)]
    preset = preset_of(settings)
    default = settings if preset is None else load_experiment(preset)  # recorded settings may have lost their order
    if list(planners) != list(default.planners):
        words += [word for name in planners for word in ("--planner", name)]
    if list(arenas) != list(default.arenas):
        words += [word for name in arenas for word in ("--arena", name)]
    words += ["--runs", str(settings.protocol.runs), "--seed", str(seed), *model_option(model), "--out", "results"]
    return shlex.join(words)


def to_toml(settings: ExperimentSettings) -> str:
    """Return the settings as TOML that ``--config`` reads back to equal settings."""
    return "\n".join(_toml(settings.model_dump(mode="json"), "")).strip() + "\n"


def _experiment(settings: ExperimentSettings) -> list[str]:
    name = preset_of(settings)
    return ["--config", SETTINGS_FILE] if name is None else ["--preset", name]


def _toml(table: dict[str, Any], path: str) -> Iterator[str]:
    """Lines of one table: its plain values first, then its tables and arrays of tables."""
    groups = {k: v for k, v in table.items() if isinstance(v, dict) or _is_tables(v)}
    for key, value in table.items():
        if key not in groups and value is not None:  # TOML has no null; a missing key means the same
            yield f"{_key(key)} = {_value(value)}"
    for key, value in groups.items():
        name = f"{path}.{_key(key)}" if path else _key(key)
        for part in value if isinstance(value, list) else [value]:
            yield ""
            yield f"[[{name}]]" if isinstance(value, list) else f"[{name}]"
            yield from _toml(part, name)


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(part, dict) for part in value)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _value(key)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return repr(value)
