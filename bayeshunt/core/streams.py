"""One random generator per role, all from one seed, so that two planners meet the same noise and the same prey."""

from __future__ import annotations

import numpy as np

__all__ = ["ROLES", "global_generator", "spawn_streams"]

#: Roles in the order of the seed's children. It never changes: a child's numbers depend on its place alone.
ROLES = ("hunter", "prey", "prey_control", "planner", "sensor", "belief")


def spawn_streams(seed: int, bodies: int = 2) -> dict[str, np.random.Generator]:
    """Return a generator for each of :data:`ROLES`, and for ``prey_2``, ``prey_2_control`` and so on.

    hunter, prey: the noise of their actuators. prey_control: what the prey's behaviour draws. planner, sensor, belief:
    what they draw. seed: any whole number >= 0. bodies: how many there are, the hunter included, >= 2.
    """
    further = [name for n in range(2, bodies) for name in (f"prey_{n}", f"prey_{n}_control")]
    names = (*ROLES, *further)
    children = np.random.SeedSequence(seed).spawn(len(names))
    return {name: np.random.default_rng(child) for name, child in zip(names, children, strict=True)}


def global_generator() -> object:
    """Return the state of numpy's global generator, comparable: for the checks that nobody touches it."""
    kind, keys, *rest = np.random.get_state(legacy=True)
    return (kind, tuple(np.asarray(keys).tolist()), *rest)
