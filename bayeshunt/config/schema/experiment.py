"""One experiment: a robot, a prey, arenas, and how they are tried."""

from __future__ import annotations

from typing import Any

from pydantic import Field, model_validator

from bayeshunt.config.schema.arena import ArenaSettings
from bayeshunt.config.schema.groups import ShownSettings
from bayeshunt.config.schema.model import ModelSettings
from bayeshunt.config.schema.prey import PreySettings
from bayeshunt.config.schema.protocol import PhysicsSettings, ProtocolSettings
from bayeshunt.config.schema.published import Published, Reported
from bayeshunt.config.schema.robot import RobotSettings
from bayeshunt.config.schema.sensing import SensingSettings
from bayeshunt.core.errors import ConfigError, did_you_mean
from bayeshunt.core.geometry import Polar, Pose

__all__ = ["ExperimentSettings"]

#: A gait that lasts longer than this [s], and than ten hunts, is one in other units.
_LONGEST_GAIT = 600.0


class ExperimentSettings(ShownSettings):
    """Everything one evaluation needs."""

    name: str = Field(min_length=1, description="name shown in tables")
    note: str = Field("", description="printed under every table made with these settings")
    scaled: str = Field("", description="said above every table: that arenas and prey were drawn to another robot")
    robot: RobotSettings
    prey: PreySettings = Field(default_factory=PreySettings)
    arenas: dict[str, ArenaSettings] = Field(
        default_factory=lambda: {"walled": ArenaSettings(walled=True), "open": ArenaSettings()}
    )
    world: str = Field(
        "box2d",
        min_length=1,
        description="what moves the bodies: box2d, mujoco or a registered world; a robot made in MuJoCo brings its own",
    )
    physics: PhysicsSettings = Field(default_factory=PhysicsSettings)
    sensing: SensingSettings = Field(default_factory=SensingSettings)
    protocol: ProtocolSettings = Field(default_factory=ProtocolSettings)
    model: ModelSettings = Field(default_factory=ModelSettings)
    planners: tuple[str, ...] = Field(
        ("reactive", "prediction", "planning"), min_length=1, description="planners that are evaluated"
    )
    planner: dict[str, dict[str, Any]] = Field(default_factory=dict, description="settings of planners, by name")
    cost: dict[str, float] = Field(
        default_factory=dict,
        description="what a hunt costs, for all planners that search: time (by default 1), distance, transitions, "
        "energy, clearance, planning, seconds_per_node; the cost in a planner's own section counts first",
    )
    published: dict[str, dict[str, Reported]] = Field(
        default_factory=dict,
        description="published figures by planner and arena: a share, or a group of "
        "caught, runs, by_theta, printed, success and mean_time",
    )

    @model_validator(mode="after")
    def _has_an_arena(self) -> ExperimentSettings:
        if not self.arenas:
            raise ValueError("arenas: at least one arena is needed")
        return self

    @model_validator(mode="after")
    def _published_by_bearing(self) -> ExperimentSettings:
        for planner, arenas in self.published.items():
            for arena, said in arenas.items():
                counts = said.by_theta if isinstance(said, Published) else None
                if counts is not None and len(counts) != len(self.protocol.thetas):
                    raise ValueError(
                        f"published.{planner}.{arena}.by_theta: {len(counts)} counts for the "
                        f"{len(self.protocol.thetas)} bearings of protocol.thetas"
                    )
        return self

    def reported(self, planner: str, arena: str) -> Published | None:
        """Return what was published of a planner in an arena, a bare share as a :class:`Published`; None if nothing."""
        said = self.published.get(planner, {}).get(arena)
        return said if said is None or isinstance(said, Published) else Published(success=said)

    def __repr__(self) -> str:
        hunts = f"{len(self.protocol.thetas)} bearings x {self.protocol.runs} runs"
        return f"<ExperimentSettings {self.name!r}: {', '.join(self.planners)} in {', '.join(self.arenas)}, {hunts}>"

    def starting_poses(self, theta: float) -> tuple[Pose, Pose]:
        """Return hunter and prey at the start, in the arena's frame: the prey at bearing ``theta`` [rad, clockwise].

        Both face the same way (identical headings), as in section 4 of the paper.
        """
        hunter = self.protocol.hunter_pose
        distance = self.protocol.prey_distance * self.robot.body.body_length
        return hunter, hunter.compose(Polar(distance, theta, 0.0))

    def check_arena(self, name: str, theta: float | None = None) -> None:
        """Raise ConfigError unless there is an arena ``name`` where neither robot starts in a wall or an obstacle.

        theta: the prey's first bearing [rad, clockwise]; by default all those of the protocol.
        """
        held, limit = self.robot.gait_duration, self.protocol.time_limit
        if held > max(_LONGEST_GAIT, 10 * limit):
            raise ConfigError(
                f"robot.gait_duration: {held:g} s, but a hunt ends after {limit:g} s; if it is in milliseconds, "
                f"give {held / 1000:g}"
            )
        if not isinstance(name, str) or name not in self.arenas:
            raise ConfigError(f"unknown arena {name!r}{did_you_mean(name, self.arenas)}")
        arena = self.arenas[name]
        if not (arena.walled or arena.obstacles):
            return
        hunter, prey = 0.5 * self.robot.body.diameter, 0.5 * self.prey.body.diameter
        for bearing in self.protocol.thetas if theta is None else (theta,):
            at, seen = self.starting_poses(float(bearing))
            for who, pose, radius in (("hunter", at, hunter), ("prey", seen, prey)):
                width, height = 2 * (abs(pose.x) + radius), 2 * (abs(pose.y) + radius)
                if arena.walled and (width > arena.width or height > arena.height):
                    raise ConfigError(
                        f"settings {self.name!r}: arenas.{name}.width and height: the {who} would start in a wall "
                        f"(theta {bearing:g}); make them at least {width:.3f} m and {height:.3f} m, or start "
                        "elsewhere (protocol.hunter_x and hunter_y)"
                    )
                for number, obstacle in enumerate(arena.obstacles, 1):
                    if obstacle.gap(pose.x, pose.y) < radius:
                        raise ConfigError(
                            f"settings {self.name!r}: arenas.{name}.obstacles {number}: the {who} would start in it "
                            f"(theta {bearing:g}, at x {pose.x:.3f} m, y {pose.y:.3f} m); move the obstacle, or start "
                            "elsewhere (protocol.hunter_x and hunter_y)"
                        )
