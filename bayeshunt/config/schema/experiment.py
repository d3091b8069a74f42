"""One experiment: a robot, a prey, arenas, and how they are tried."""

from __future__ import annotations

from typing import Any

from pydantic import Field, model_validator

from bayeshunt.config.schema.arena import ArenaSettings
from bayeshunt.config.schema.groups import ShownSettings
from bayeshunt.config.schema.model import ModelSettings
from bayeshunt.config.schema.prey import PreySettings
from bayeshunt.config.schema.protocol import PhysicsSettings, ProtocolSettings
from bayeshunt.config.schema.robot import RobotSettings
from bayeshunt.core.errors import ConfigError, did_you_mean

__all__ = ["ExperimentSettings"]


class ExperimentSettings(ShownSettings):
    """Everything one evaluation needs."""

    name: str = Field(min_length=1, description="name shown in tables")
    note: str = Field("", description="printed under every table made with these settings")
    robot: RobotSettings
    prey: PreySettings = Field(default_factory=PreySettings)
    arenas: dict[str, ArenaSettings] = Field(
        default_factory=lambda: {"walled": ArenaSettings(walled=True), "open": ArenaSettings()}
    )
    physics: PhysicsSettings = Field(default_factory=PhysicsSettings)
    protocol: ProtocolSettings = Field(default_factory=ProtocolSettings)
    model: ModelSettings = Field(default_factory=ModelSettings)
    planners: tuple[str, ...] = Field(
        ("reactive", "prediction", "planning"), min_length=1, description="planners that are evaluated"
    )
    planner: dict[str, dict[str, Any]] = Field(default_factory=dict, description="settings of planners, by name")
    published: dict[str, dict[str, float]] = Field(
        default_factory=dict, description="published success [share], by planner and arena"
    )

    @model_validator(mode="after")
    def _has_an_arena(self) -> ExperimentSettings:
        if not self.arenas:
            raise ValueError("arenas: at least one arena is needed")
        return self

    def __repr__(self) -> str:
        hunts = f"{len(self.protocol.thetas)} bearings x {self.protocol.runs} runs"
        return f"<ExperimentSettings {self.name!r}: {', '.join(self.planners)} in {', '.join(self.arenas)}, {hunts}>"

    def check_arena(self, name: str) -> None:
        """Raise ConfigError unless there is an arena ``name`` in which the prey does not start in a wall."""
        if not isinstance(name, str) or name not in self.arenas:
            raise ConfigError(f"unknown arena {name!r}{did_you_mean(name, self.arenas)}")
        arena = self.arenas[name]
        reach = self.protocol.prey_distance * self.robot.body.diameter + 0.5 * self.prey.body.diameter
        if arena.walled and reach > 0.5 * min(arena.width, arena.height):
            raise ConfigError(
                f"settings {self.name!r}: arenas.{name}.width and height: the prey would start in a wall; "
                f"make both larger than {2 * reach:.3f} m"
            )
