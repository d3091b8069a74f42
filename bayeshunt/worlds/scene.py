"""What a world is made from."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from bayeshunt.config.schema import ArenaSettings, NoiseSettings, PhysicsSettings, PreySettings, RobotSettings

__all__ = ["HUNTER", "PREY", "Scene"]

#: Names of the bodies; a second prey is "prey_2".
HUNTER, PREY = "hunter", "prey"
_NO_NOISE = NoiseSettings(slip=0.0, drift_sd=0.0)


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

    def quiet(self, *, alone: bool) -> Scene:
        """Return the scene without noise; ``alone``: and with a prey that senses no hunter."""
        changes: dict[str, Any] = {"noise": _NO_NOISE, "sensor_noise": 0.0, "turn_sd": 0.0}
        if alone:
            changes["senses_hunter"] = False
        return replace(
            self,
            robot=self.robot.model_copy(update={"noise": _NO_NOISE}),
            prey=None if self.prey is None else self.prey.model_copy(update=changes),
        )
