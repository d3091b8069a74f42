"""What the prey of a trial would do from now on if nothing disturbed it: for upper bounds, not for hunters."""

from __future__ import annotations

import numpy as np

from bayeshunt.core.geometry import FloatArray, Pose
from bayeshunt.core.protocols import World
from bayeshunt.worlds.scene import PREY

__all__ = ["foresee"]


def foresee(world: World, duration: float, prey: str = PREY) -> tuple[np.ndarray, Pose[FloatArray]]:
    """Return times [M] from now [s] and the prey's poses then (a Pose of arrays [M]), one per control interval.

    A copy of the prey, in the state it is in now, runs alone and without noise in a twin of the world. It does not
    meet the hunter: what a prey that senses the hunter would do about it is not foreseen, and neither are the random
    turns of a behaviour that makes any (its controller starts anew, with its noise off).

    duration: how far to look [s]; the last pose is at or after it.
    """
    interval = world.control_interval
    twin = world.fork(prey)
    poses = [twin.bodies[prey].pose]
    run = twin.run({}, int(np.ceil(duration / interval - 1e-9)) * interval)
    poses += [moment.poses[prey] for moment in run.moments]
    twin.close()
    return interval * np.arange(len(poses)), Pose(*np.array(poses).T)
