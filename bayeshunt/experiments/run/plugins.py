"""Prey and planners of one's own: from a file, and on to the worker processes."""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import importlib.util
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from bayeshunt.core.errors import BayesHuntError, InputError
from bayeshunt.planners.registry import adopt_planner, registered_planners
from bayeshunt.worlds.prey.behaviours import register_prey, registered_prey

_REGISTER = "call bayeshunt.register_prey(name, class) or bayeshunt.register_planner(name, class) in it"


class Additions(NamedTuple):
    """What has been registered in one process beside what ships: prey behaviours and planners, by name."""

    prey: dict[str, Any]
    planners: dict[str, Any]

    @classmethod
    def here(cls) -> Additions:
        """Return the additions of this process."""
        return cls(registered_prey(), registered_planners())

    def adopt(self) -> None:
        """Know them in this process too."""
        known = registered_prey()
        for name, behaviour in self.prey.items():
            if name not in known:
                register_prey(name, behaviour)
        for name, entry in self.planners.items():
            adopt_planner(name, entry)


def used_additions(planners: Iterable[str], behaviour: str) -> dict[str, Any]:
    """Return the class or function behind each planner, and behind the prey, that does not ship, by what it is."""
    here = Additions.here()
    used = {f"with planner {name}": here.planners[name].factory for name in planners if name in here.planners}
    if behaviour in here.prey:
        used[f"with prey {behaviour}"] = here.prey[behaviour]
    return used


def load_plugin(path: str | os.PathLike[str]) -> ModuleType:
    """Run a Python file of the user's that calls ``register_prey`` or ``register_planner``.

    Raises InputError in one line if the file is missing, fails or registers nothing.
    """
    file = Path(path)
    if not file.is_file():
        raise InputError(f"{file}: no such file; expected a Python file that registers prey or planners")
    # Two files may have one name.
    name = f"bayeshunt_plugin_{file.stem}_{hashlib.sha256(os.fsencode(file.resolve())).hexdigest()[:8]}"
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise InputError(f"{file}: expected a Python file (.py)")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    before = Additions.here()
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        kind = "" if isinstance(error, BayesHuntError) else f"{type(error).__name__}: "
        raise InputError(f"{file}: {kind}{error}") from error
    if Additions.here() == before:
        raise InputError(f"{file}: registers nothing; {_REGISTER}")
    _send_by_value(module)
    return module


def _send_by_value(module: ModuleType) -> None:
    """Let workers get the plugin's classes whole: they cannot import a file that only this process has read."""
    for name in ("cloudpickle", "joblib.externals.cloudpickle"):  # joblib brought its own copy before 1.6
        with contextlib.suppress(ImportError):
            importlib.import_module(name).register_pickle_by_value(module)
