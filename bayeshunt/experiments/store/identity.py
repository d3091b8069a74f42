"""What makes two evaluations the same: settings, planners, arenas, seed, model and versions.

Everything that can change a single bit of the results is part of the identity, nothing else is: the
number of workers and where they run are not.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from itertools import zip_longest
from pathlib import Path
from typing import Any

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.config.schema.prey import PreySettings
from bayeshunt.experiments.run.plugins import used_additions
from bayeshunt.experiments.run.sources import source_hashes
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.formats import model_file as model_files
from bayeshunt.worlds.box2d.version import version as box2d_version
from bayeshunt.worlds.prey.names import RECORDED, is_recorded

__all__ = ["LIBRARIES", "Identity", "fingerprint", "model_fingerprint", "versions"]

#: Distributions whose version may change a result: all that the world, the models, the planners and the hunt import.
LIBRARIES = ("bayeshunt", "box2d", "mujoco", "numpy", "pandas", "pgmpy", "pykalman", "scipy", "shapely")
_ABSENT = "not given"
_MISSING = "not installed"
#: Those that only some worlds need.
_EXTRAS = ("mujoco",)

#: Settings that change with the others: the words under a table, and the figures it is held against.
_FOLLOWING = (".note", ".published")
#: Files that the prey's settings may name; folders made before these were noted go on.
_PREY_FILES = ("prey.model", "prey.behaviour")


@dataclass(frozen=True)
class Identity:
    """One evaluation.

    settings, planners, arenas, seed: as asked. versions: by library name.
    files: SHA-256 of each file that a planner's settings or the prey's model or behaviour name, by dotted key, and of
        the source of planners and prey that do not ship, with what it imports from its own folder.
    learned: True if the model is babbled and fitted by the evaluation itself, from settings and seed.
    model: fingerprint of the model's tables; "" while a model that is to be learned is not yet known.
    """

    settings: dict[str, Any]
    planners: tuple[str, ...]
    arenas: tuple[str, ...]
    seed: int
    versions: dict[str, str]
    files: dict[str, str]
    learned: bool
    model: str = ""

    @classmethod
    def of(
        cls, settings: ExperimentSettings, planners: Sequence[str], arenas: Sequence[str], seed: int, model: str | None
    ) -> Identity:
        """Return the identity of an evaluation by this installation; ``model`` None: learned from the seed."""
        plain = json.loads(json.dumps(settings.model_dump(mode="json")))
        files = dict(_files({name: plain["planner"].get(name, {}) for name in planners}, settings.prey))
        files |= source_hashes(used_additions(planners, settings.prey.behaviour, settings))
        return cls(plain, tuple(planners), tuple(arenas), int(seed), versions(), files, model is None, model or "")

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> Identity:
        """Rebuild from :meth:`to_dict`; KeyError or TypeError if the record is something else."""
        names = {"planners": tuple(record["planners"]), "arenas": tuple(record["arenas"])}
        return cls(**{**record, **names})

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        return {**self.__dict__, "planners": list(self.planners), "arenas": list(self.arenas)}

    @property
    def hash(self) -> str:
        """SHA-256 over everything, in hexadecimal: the settings hash of a results folder."""
        return hashlib.sha256(json.dumps(self.to_dict(), sort_keys=True).encode()).hexdigest()

    def difference(self, other: Identity) -> str | None:
        """Return the first thing in which ``other`` differs, "seed is 0 there and 1 here"; None if nothing does.

        Folders made when fewer libraries and files were noted are held to what they note.
        """
        versions, files = other.versions, dict(other.files)
        for key in _PREY_FILES:  # the settings name the same one, so a folder without its digest never noted it
            if key not in self.files:
                files.pop(key, None)
        if not versions.keys() <= self.versions.keys():
            versions, files = (
                {key: value for key, value in theirs.items() if key in mine}
                for mine, theirs in ((self.versions, versions), (self.files, files))
            )
        pairs = (
            (self.settings, other.settings, "settings"),
            (list(self.planners), list(other.planners), "planners"),
            (list(self.arenas), list(other.arenas), "arenas"),
            (self.seed, other.seed, "seed"),
            (self.versions, versions, "version of"),
            (self.files, files, "SHA-256 of the file"),
            (_model_kind(self), _model_kind(other), "the model"),
        )
        for mine, theirs, name in pairs:
            # what follows from another change is named only if nothing else differs
            for key, one, two in sorted(_differences(mine, theirs), key=lambda found: found[0].startswith(_FOLLOWING)):
                return f"{_readable(name, key)} is {_short(one)} there and {_short(two)} here"
        if self.model and other.model and self.model != other.model:
            return f"the model has fingerprint {self.model[:12]} there and {other.model[:12]} here"
        return None


def versions() -> dict[str, str]:
    """Return the versions of the libraries that a result depends on; an extra that is not installed has none."""
    found = {name: _version(name) for name in LIBRARIES}
    return {name: version for name, version in found.items() if name not in _EXTRAS or version != _MISSING}


def fingerprint(model_text: str) -> str:
    """Return a SHA-256 in hexadecimal over all of a model file that decides its answers: not its provenance."""
    content = json.loads(model_text)["content"]
    content.pop("provenance", None)
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def model_fingerprint(model: ForwardModel) -> str | None:
    """Return the :func:`fingerprint` of a model; None for an imported network, which no model file can hold."""
    return fingerprint(model_files.dumps(model)) if model.has_counts else None


def _files(planner: dict[str, Any], prey: PreySettings) -> Iterator[tuple[str, str]]:
    """Yield (dotted key, SHA-256) of every setting of a planner or of the prey that names a file."""
    named = {f"planner.{name}.{key}": value for name, values in planner.items() for key, value in values.items()}
    # a prey's model or behaviour is a file only where its name says so, whatever else lies in this folder
    if prey.model.lower().endswith(".json"):
        named[_PREY_FILES[0]] = prey.model
    if is_recorded(prey.behaviour):
        named[_PREY_FILES[1]] = prey.behaviour.removeprefix(RECORDED).rpartition("#")[0]
    for key, value in named.items():
        if isinstance(value, str) and Path(value).is_file():
            yield key, hashlib.sha256(Path(value).read_bytes()).hexdigest()


@cache
def _version(name: str) -> str:
    """Read once per process, not once per batch of hunts; a worker elsewhere may lack one."""
    if name == "box2d":  # two packages bring it, so it says itself which version it is
        return box2d_version()
    try:
        return version(name)
    except PackageNotFoundError:
        return _MISSING


def _model_kind(identity: Identity) -> str:
    return "learned from the seed" if identity.learned else "given with --model"


def _differences(one: Any, two: Any, key: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Yield (dotted key, value, value) for every leaf that differs."""
    if isinstance(one, dict) and isinstance(two, dict):
        for name in [*one, *(n for n in two if n not in one)]:
            yield from _differences(one.get(name, _ABSENT), two.get(name, _ABSENT), f"{key}.{name}")
    elif isinstance(one, list) and isinstance(two, list) and _nested(one, two):
        for index, (left, right) in enumerate(zip_longest(one, two, fillvalue=_ABSENT)):
            yield from _differences(left, right, f"{key}[{index}]")
    elif one != two or type(one) is not type(two):
        yield key, one, two


def _nested(one: list[Any], two: list[Any]) -> bool:
    return any(isinstance(value, dict) for value in [*one, *two])


def _readable(name: str, key: str) -> str:
    key = key.removeprefix(".")
    return key if name == "settings" else f"{name} {key}".rstrip()


def _short(value: Any) -> str:
    text = ", ".join(map(str, value)) if isinstance(value, list) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."
