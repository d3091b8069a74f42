"""What a hunter learns of its prey, by name: ``prey.model`` in an experiment's settings.

A name that ends in .json is a file of ``bayeshunt prey fit``: what is known of such prey beforehand.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path

from bayeshunt.core.arguments import checked
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.checks import conforms
from bayeshunt.core.errors import InputError, did_you_mean, shown
from bayeshunt.core.protocols import TargetModel
from bayeshunt.models.target.following import ConstantVelocity
from bayeshunt.models.target.prey import PreyModel

__all__ = [
    "COUNTS", "check_prey_model_name", "is_prey_model", "make_prey_model", "prey_model_names", "register_prey_model",
    "registered_prey_models",
]  # fmt: skip

#: Makes a model that knows nothing yet from the bins of the experiment.
Factory = Callable[[EffectAxes], TargetModel]
#: The model that ships: how often each pose transition was seen.
COUNTS = "counts"

_MODELS: dict[str, Factory] = {COUNTS: PreyModel, "constant_velocity": ConstantVelocity}
_SHIPPED = frozenset(_MODELS)


@checked
def register_prey_model(name: str, factory: Factory) -> None:
    """Give a model of the prey a name that ``prey.model`` may use.

    factory: called with the experiment's bins (``EffectAxes``) at the start of every hunt, gives a model that knows
    nothing yet: a ``bayeshunt.protocols.TargetModel``. Worker processes are told of it too. Raises InputError if the
    name is empty or ships, or nothing can be called.
    """
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"a prey model needs a name, got {shown(name)}")
    if name in _SHIPPED:
        raise InputError(f"a prey model called {name!r} ships already; choose another name")
    if not callable(factory):
        raise InputError(f"prey model {name!r}: expected what makes one from EffectAxes, got {shown(factory)}")
    _MODELS[name] = factory


def registered_prey_models() -> Mapping[str, Factory]:
    """Return the prey models registered beside those that ship, by name."""
    return {name: factory for name, factory in _MODELS.items() if name not in _SHIPPED}


def prey_model_names() -> list[str]:
    """Return the names of all prey models."""
    return sorted(_MODELS)


def make_prey_model(name: str, axes: EffectAxes) -> TargetModel:
    """Return a model of this prey that knows nothing yet, or a file's.

    Raises InputError for an unknown name, or if what was made is none; ModelFileError for a file that cannot be read.
    """
    check_prey_model_name(name)
    if _is_file(name):
        return _loaded(name, Path(name).stat().st_mtime_ns).copy()
    model = _MODELS[name](axes)
    if not is_prey_model(model):
        raise InputError(f"prey model {name!r}: {shown(model)} is no bayeshunt.protocols.TargetModel")
    return model


def is_prey_model(thing: object) -> bool:
    """Return whether a thing has all that the hunt, its record and the planners use of a prey model."""
    return conforms(thing, TargetModel)


def check_prey_model_name(name: str) -> None:
    """Raise InputError if no prey model is called ``name``, ModelFileError if a file cannot be read."""
    if _is_file(name):
        _loaded(name, Path(name).stat().st_mtime_ns if Path(name).exists() else 0)
    elif name not in _MODELS:
        raise InputError(f"prey.model: unknown prey model {name!r}{did_you_mean(name, prey_model_names())}")


def _is_file(name: str) -> bool:
    return name.lower().endswith(".json")


@lru_cache(maxsize=8)
def _loaded(name: str, changed: int) -> PreyModel:
    """The model in a file that was last ``changed`` then."""
    return PreyModel.load(name)
