"""An experiment drawn to its hunter: arenas in body lengths, the prey in body lengths and shares of the top speed.

Lengths follow the ratio of body lengths, L, and speeds the ratio of top speeds, S; what is made of both follows as in
a drawing of another scale: times as L / S, accelerations as S S / L, rates of turning as S / L.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bayeshunt.config.schema import ArenaSettings, BodySettings, PreySettings, RobotSettings
from bayeshunt.core.units import length, speed

__all__ = ["absolute", "rescaled"]

#: Keys of a prey by the powers of L and S that they follow.
_PREY = {
    "speed": (0, 1), "sensor_range": (1, 0), "turn_sd": (-1, 1), "turn_rate": (-1, 1), "turn_time": (1, -1),
}  # fmt: skip
_PREY_BODY = {
    "diameter": (1, 0), "axle": (1, 0), "wheelbase": (1, 0), "max_acceleration": (-1, 2), "max_traction": (-1, 2),
}  # fmt: skip
#: Of what is given relative to the hunter; and what a prey that leaves it out is: as large as a Khepera to a Khepera.
_LENGTHS = {"speed": (0, 1), "sensor_range": (1, 0)}
_BODY_LENGTHS = {"diameter": (1, 0), "axle": (1, 0), "wheelbase": (1, 0)}
_OF_THE_PAPER = {"speed": 5 / 6, "sensor_range": 0.05 / 0.057}
_ITS_BODY = {"diameter": 1.0, "axle": 0.052 / 0.057, "wheelbase": 0.045 / 0.057}
_PLACE = {"hunter_x": (1, 0), "hunter_y": (1, 0)}


def rescaled(values: Mapping[str, Any], old: RobotSettings, new: RobotSettings) -> dict[str, Any]:
    """Return settings of an experiment with hunter ``old`` drawn to the hunter ``new``; the robot itself stays.

    What is given relative to the hunter follows by itself. Values are rounded to 6 digits; those of a hunter of the
    same length and top speed stay as they are. ``scaled`` says what was done.
    """
    length_ratio, speed_ratio = _ratios(old, new)
    made = dict(values)
    if length_ratio == speed_ratio == 1.0 or not all(
        isinstance(values.get(group, {}), dict) for group in ("arenas", "prey", "protocol")
    ):
        return made  # no group of settings: that is said later, with its key
    made["arenas"] = {name: _arena(group, length_ratio) for name, group in values.get("arenas", {}).items()}
    prey = values.get("prey", {})
    if not prey.get("relative", False):
        made["prey"] = _scale(prey, PreySettings, _PREY, length_ratio, speed_ratio)
        inside = prey.get("body", {})
        made["prey"]["body"] = _scale(inside, BodySettings, _PREY_BODY, length_ratio, speed_ratio)
    if "protocol" in values:
        made["protocol"] = {
            key: _times(value, *_PLACE[key], length_ratio, speed_ratio) if key in _PLACE else value
            for key, value in values["protocol"].items()
        }
    fastest = new.known_top_speed
    made["scaled"] = (
        f"Arenas and prey are drawn to {new.name} ({length(new.body.body_length)} long"
        + ("" if fastest is None else f", top speed {speed(fastest)}")
        + f"): lengths x {length_ratio:.3g}, speeds x {speed_ratio:.3g}."
    )
    return made


def absolute(values: Mapping[str, Any], hunter: RobotSettings) -> dict[str, Any]:
    """Return settings of an experiment with what they give relative to the hunter in metres and seconds."""
    body, made = hunter.body.body_length, dict(values)
    arenas: dict[str, Any] = {}
    for name, group in values.get("arenas", {}).items():
        arenas[name] = group
        if isinstance(group, dict) and group.get("in_bodies") is True:
            arenas[name] = {**_arena({**group, "in_bodies": False}, body), "in_bodies": False}
    if arenas:
        made["arenas"] = arenas
    prey = values.get("prey", {})
    if isinstance(prey, dict) and prey.get("relative") is True:
        top, inside = hunter.top_speed, prey.get("body", {})
        made["prey"] = {**_scale(_OF_THE_PAPER | prey, PreySettings, _LENGTHS, body, top), "relative": False}
        if isinstance(inside, dict):
            made["prey"]["body"] = _scale(_ITS_BODY | inside, BodySettings, _BODY_LENGTHS, body, top)
    return made


def _ratios(old: RobotSettings, new: RobotSettings) -> tuple[float, float]:
    """Ratio of lengths and of top speeds; speeds go with the lengths where one of them is not known."""
    length_ratio = new.body.body_length / old.body.body_length
    before, after = old.known_top_speed, new.known_top_speed
    return length_ratio, after / before if before and after else length_ratio


def _arena(group: Any, length_ratio: float) -> Any:
    if not isinstance(group, dict) or group.get("in_bodies") is True:
        return group
    made = _scale(group, ArenaSettings, {"width": (1, 0), "height": (1, 0)}, length_ratio, 1.0)
    things = group.get("obstacles", ())
    if isinstance(things, (list, tuple)):
        made["obstacles"] = [_obstacle(thing, length_ratio) for thing in things]
    return made


def _obstacle(thing: Any, length_ratio: float) -> Any:
    if not isinstance(thing, dict):
        return thing
    lengths = ("x", "y", "radius", "width", "height")
    return {key: _times(value, 1, 0, length_ratio, 1.0) if key in lengths else value for key, value in thing.items()}


def _scale(
    group: Any, kind: type[Any], powers: Mapping[str, tuple[int, int]], length_ratio: float, speed_ratio: float
) -> Any:  # fmt: skip
    """The group, its defaults among them, every key scaled by its powers of L and S."""
    if not isinstance(group, dict):
        return group  # said later, with its key
    made = dict(group)
    for key, (of_l, of_s) in powers.items():
        value = made.get(key, kind.model_fields[key].default)
        made[key] = _times(value, of_l, of_s, length_ratio, speed_ratio)
    return made


def _times(value: Any, of_l: int, of_s: int, length_ratio: float, speed_ratio: float) -> Any:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return value  # said later, with its key
    factor = length_ratio**of_l * speed_ratio**of_s
    return value if factor == 1.0 else float(f"{value * factor:.6g}")
