"""Worlds by name: ``world = "box2d"`` in an experiment, or one of your own."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from bayeshunt.config.schema.drives import find_drive
from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import conforms
from bayeshunt.core.errors import InputError, did_you_mean, shown
from bayeshunt.core.protocols import World
from bayeshunt.worlds.prey.names import is_recorded
from bayeshunt.worlds.scene import Scene

__all__ = [
    "BOX2D",
    "WorldFactory",
    "check_world_name",
    "make_world",
    "register_world",
    "registered_worlds",
    "world_names",
]

#: Makes a world from a scene.
WorldFactory = Callable[[Scene], World]
#: The worlds that ship.
BOX2D, MUJOCO = "box2d", "mujoco"


def _box2d(scene: Scene) -> World:
    # only when asked for: another engine needs no Box2D
    if scene.prey is not None and is_recorded(scene.prey.behaviour):
        from bayeshunt.worlds.recorded.world import RecordedWorld

        return RecordedWorld(scene)
    from bayeshunt.worlds.box2d.world import Box2DWorld

    return Box2DWorld(scene)


def _mujoco(scene: Scene) -> World:
    from bayeshunt.worlds.mujoco.world import MujocoWorld  # an extra: only when asked for

    return MujocoWorld(scene)


_WORLDS: dict[str, WorldFactory] = {BOX2D: _box2d, MUJOCO: _mujoco}
_SHIPPED = frozenset(_WORLDS)


@checked
def register_world(name: str, factory: WorldFactory) -> None:
    """Give a world a name that ``world = NAME`` in an experiment may use.

    factory: called with a :class:`Scene` for every trial, gives a ``bayeshunt.protocols.World``. Worker processes of an
    evaluation are told of it too. Raises InputError if the name is empty or ships, or nothing can be called.
    """
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"a world needs a name, got {shown(name)}")
    if name in _SHIPPED:
        raise InputError(f"a world called {name!r} ships already; choose another name")
    if not callable(factory):
        raise InputError(f"world {name!r}: expected what makes one from a Scene, got {shown(factory)}")
    _WORLDS[name] = factory


def registered_worlds() -> Mapping[str, WorldFactory]:
    """Return the worlds registered beside those that ship, by name."""
    return {name: factory for name, factory in _WORLDS.items() if name not in _SHIPPED}


def world_names() -> list[str]:
    """Return the names of all worlds."""
    return sorted(_WORLDS)


def make_world(name: str, scene: Scene) -> World:
    """Return a fresh world for one trial; InputError if none is called ``name``, or what was made is none.

    A robot whose body is made in another world than "box2d" brings its own where that is named.
    """
    check_world_name(name)
    if name == BOX2D:
        name = find_drive(scene.robot.body.drive).world
    world = _WORLDS[name](scene)
    if not conforms(world, World):
        raise InputError(f"world {name!r}: {shown(world)} is no bayeshunt.protocols.World; run bayeshunt.check_world")
    return world


def check_world_name(name: str) -> None:
    """Raise InputError if no world is called ``name``."""
    if name not in _WORLDS:
        raise InputError(f"unknown world {name!r}{did_you_mean(name, world_names())}")
