"""What a world is made from."""

from __future__ import annotations

from dataclasses import dataclass

from bayeshunt.config.schema import ArenaSettings, PhysicsSettings, PreySettings, RobotSettings

__all__ = ["HUNTER", "PREY", "Scene"]

#: Names of the bodies; a second prey is "prey_2".
HUNTER, PREY = "hunter", "prey"


@dataclass(frozen=True)
class Scene:
    """Who is where: the settings that a world needs, and nothing of those who think.

    robot: the hunter. prey: the prey; None: the robot is alone, as when it babbles. arena: the walls and obstacles.
    physics: how time advances.
    """

    robot: RobotSettings
    prey: PreySettings | None
    arena: ArenaSettings
    physics: PhysicsSettings
