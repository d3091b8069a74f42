"""One MJCF model of a whole trial: the ground, walls and obstacles, the hunter's own MJCF, and a disc for every prey.

Contacts by bits: what is solid in the hunter touches everything, a prey everything but the ground, on which it floats.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

from bayeshunt.config.schema import ArenaSettings
from bayeshunt.config.schema.mujoco import MujocoSettings
from bayeshunt.core.errors import InputError
from bayeshunt.worlds.mujoco.engine import load

__all__ = ["TRUNK", "Disc", "build"]

#: The body of an MJCF model that the robot's pose is taken from; it hangs on a free joint.
TRUNK = "trunk"
_GROUND, _HUNTER, _WALL, _PREY = 1, 2, 4, 8
_HIGH = 0.05  # m: half the height of walls and prey
_MASS = 0.2  # kg, of a prey
_GRIP = 40.0  # N s/m: how fast a prey's wheels take hold


class Disc(NamedTuple):
    """A prey's body: its name, its diameter [m], and the acceleration that its tyres carry [m/s2]."""

    name: str
    diameter: float
    traction: float


@lru_cache(maxsize=16)
def build(settings: MujocoSettings | None, discs: Sequence[Disc], arena: ArenaSettings, step: float) -> Any:
    """Return the compiled ``MjModel``; ``settings``: of the hunter, None: it is left out. step: seconds.

    Raises InputError if the hunter's MJCF cannot be read, or has no trunk on a free joint, no actuators or no
    keyframe "stand".
    """
    mujoco = load()
    spec = mujoco.MjSpec() if settings is None else _hunter(mujoco, settings)
    spec.option.timestep = step
    grip = {} if settings is None else {"friction": [settings.friction, 0.005, 0.0001]}
    world, plane = spec.worldbody, mujoco.mjtGeom.mjGEOM_PLANE
    world.add_geom(name="ground", type=plane, size=[0, 0, 1], contype=_GROUND, conaffinity=0, **grip)
    _walls(mujoco, world, arena)
    for disc in discs:
        _prey(mujoco, spec, disc)
    try:
        return spec.compile()
    except ValueError as error:
        raise InputError(f"robot.body.model: MuJoCo cannot use it ({str(error).splitlines()[0]})") from None


def _hunter(mujoco: Any, settings: MujocoSettings) -> Any:
    """The hunter's MJCF, its solid parts made to touch, and a sensor of force and speed for each actuator."""
    spec = _read(mujoco, settings.model)
    trunk = next((body for body in spec.bodies if body.name == TRUNK), None)
    free = trunk is not None and any(joint.type == mujoco.mjtJoint.mjJNT_FREE for joint in trunk.joints)
    if not free or not spec.actuators or not any(key.name == "stand" for key in spec.keys):
        raise InputError(
            f"robot.body.model {settings.model!r}: expected MJCF with a body {TRUNK!r} on a free joint, actuators, and "
            "a keyframe 'stand'"
        )
    for geom in spec.geoms:
        if geom.contype or geom.conaffinity:
            geom.contype, geom.conaffinity = _HUNTER, _GROUND | _WALL | _PREY
            geom.friction = [settings.friction, 0.005, 0.0001]
    for kind in (mujoco.mjtSensor.mjSENS_ACTUATORFRC, mujoco.mjtSensor.mjSENS_ACTUATORVEL):
        for actuator in spec.actuators:
            spec.add_sensor(type=kind, objtype=mujoco.mjtObj.mjOBJ_ACTUATOR, objname=actuator.name)
    return spec


def _read(mujoco: Any, name: str) -> Any:
    try:
        if name == "puppy":
            text = (resources.files("bayeshunt") / "worlds" / "mujoco" / "puppy.xml").read_text(encoding="utf-8")
            return mujoco.MjSpec.from_string(text)
        if not Path(name).is_file():
            raise InputError(f"robot.body.model: {name!r} is neither puppy nor the path of an MJCF file")
        return mujoco.MjSpec.from_file(name)
    except ValueError as error:
        raise InputError(f"robot.body.model {name!r}: not MJCF ({str(error).splitlines()[0]})") from None


def _walls(mujoco: Any, world: Any, arena: ArenaSettings) -> None:
    box, cylinder = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER
    solid: dict[str, Any] = {"contype": _WALL, "conaffinity": 0, "friction": [0.0, 0.0, 0.0]}
    if arena.walled:
        x, y, thick = 0.5 * arena.width, 0.5 * arena.height, 0.1
        for side in (-1, 1):
            world.add_geom(type=box, pos=[side * (x + thick), 0, _HIGH], size=[thick, y + 2 * thick, _HIGH], **solid)
            world.add_geom(type=box, pos=[0, side * (y + thick), _HIGH], size=[x + 2 * thick, thick, _HIGH], **solid)
    for thing in arena.obstacles:
        at = [thing.x, thing.y, _HIGH]
        if thing.radius is not None:
            world.add_geom(type=cylinder, pos=at, size=[thing.radius, _HIGH, 0], **solid)
        else:
            width, height = thing.sides
            world.add_geom(type=box, pos=at, size=[width / 2, height / 2, _HIGH], euler=[0, 0, thing.angle], **solid)


def _prey(mujoco: Any, spec: Any, disc: Disc) -> None:
    """A disc that slides over the plane, and an actuator of the speed along x, along y, and of turning."""
    body = spec.worldbody.add_body(name=disc.name, pos=[0, 0, _HIGH])
    radius = 0.5 * disc.diameter
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[radius, 0.6 * _HIGH, 0], mass=_MASS, contype=_PREY,
        conaffinity=_WALL | _PREY, friction=[0.0, 0.0, 0.0],
    )  # fmt: skip
    slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
    inertia = 0.5 * _MASS * radius * radius
    for part, kind, axis, gain, most in (
        ("x", slide, [1, 0, 0], _GRIP, _MASS * disc.traction),
        ("y", slide, [0, 1, 0], _GRIP, _MASS * disc.traction),
        ("turn", hinge, [0, 0, 1], 200.0 * inertia, 1e3 * inertia),
    ):
        name = f"{disc.name}_{part}"
        body.add_joint(name=name, type=kind, axis=axis)
        actuator = spec.add_actuator(
            name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT, forcelimited=1, forcerange=[-most, most]
        )
        actuator.set_to_velocity(gain)
