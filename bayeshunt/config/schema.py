"""Typed, frozen settings of robots, prey, arenas and protocols, read from TOML.

Every key has a unit, a range and a default here, and nowhere else. A wrong key or value is a
:class:`~bayeshunt.core.errors.ConfigError` of one line that names the file, the key and the mend.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from bayeshunt.core import displays
from bayeshunt.core.checks import FULL_TURN, beyond_a_turn
from bayeshunt.core.errors import ConfigError
from bayeshunt.core.gaits import Gait, GaitRepertoire

Positive = Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)]
Finite = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)]


class Settings(BaseModel):
    """A frozen group of settings; unknown keys are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class BodySettings(Settings):
    """A disc-shaped body and its drive. Defaults are the Khepera's (Webots' model)."""

    drive: Literal["differential", "car"] = Field("differential", description="how commands move the body")
    diameter: Positive = Field(0.057, description="disc diameter = one body length [m]")
    axle: Positive = Field(0.052, description="distance between the driven wheels [m] (differential)")
    wheelbase: Positive = Field(0.045, description="front to rear axle [m] (car)")
    max_steering: Annotated[float, Field(gt=0, lt=math.pi / 2)] = Field(
        0.6, description="largest steering angle [rad] (car)"
    )
    max_steering_rate: Positive = Field(2.0, description="steering speed limit [rad/s] (car)")
    max_acceleration: Positive = Field(0.6, description="wheel acceleration limit [m/s2]")
    max_traction: Positive = Field(3.0, description="largest change of body velocity the tyres carry [m/s2]")


class NoiseSettings(Settings):
    """Multiplicative noise of each actuator: (1 + slip) (1 + drift)."""

    slip: Share = Field(0.10, description="half-width of the uniform slip, redrawn every control interval [share]")
    drift_sd: Share = Field(0.025, description="standard deviation of the Ornstein-Uhlenbeck drift [share]")
    drift_time: Positive = Field(0.5, description="time constant of the drift [s]")


class GaitSettings(Settings):
    """One gait: left and right wheel speed (differential) or speed and steering (car)."""

    name: str = Field(min_length=1, max_length=200, description="unique name")
    left: Finite | None = Field(None, description="left wheel speed [m/s] (differential)")
    right: Finite | None = Field(None, description="right wheel speed [m/s] (differential)")
    speed: Finite | None = Field(None, description="speed of the rear axle [m/s] (car)")
    steering: Finite | None = Field(None, description="steering angle, left positive [rad] (car)")


_COMMAND_KEYS = {"differential": ("left", "right"), "car": ("speed", "steering")}


class ShownSettings(Settings):
    """Settings that show themselves: as text, and in a notebook."""

    def __str__(self) -> str:
        return displays.to_text(self)

    def _repr_html_(self) -> str | None:
        return displays.to_html(self)


class RobotSettings(ShownSettings):
    """A robot: a body, its noise and its gaits."""

    name: str = Field(min_length=1, description="name shown in tables")
    description: str = Field("", description="one line about the robot")
    gait_duration: Positive = Field(3.328, description="how long one gait is held: the time-step [s]")
    body: BodySettings = Field(default_factory=BodySettings)
    noise: NoiseSettings = Field(default_factory=NoiseSettings)
    gait: tuple[GaitSettings, ...] = Field(min_length=1, description="the gaits, in table order")

    @model_validator(mode="after")
    def _commands_fit_the_drive(self) -> RobotSettings:
        keys = _COMMAND_KEYS[self.body.drive]
        other = [k for drive, ks in _COMMAND_KEYS.items() if drive != self.body.drive for k in ks]
        for gait in self.gait:
            if any(getattr(gait, key) is None for key in keys) or any(getattr(gait, k) is not None for k in other):
                raise ValueError(f"gait {gait.name!r} of a {self.body.drive} drive needs {keys[0]} and {keys[1]}")
        if self.body.drive == "car":
            for gait in self.gait:
                if abs(gait.steering or 0.0) > self.body.max_steering:
                    raise ValueError(f"gait {gait.name!r} steers beyond body.max_steering = {self.body.max_steering}")
        names = [gait.name for gait in self.gait]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"gait name {name!r} stands twice; names must be unique")
        return self

    def __repr__(self) -> str:
        return f"<RobotSettings {self.name!r}: {self.body.drive} drive, {len(self.gait)} gaits>"

    @property
    def top_speed(self) -> float:
        """The fastest that any gait drives the body's centre, without noise [m/s]."""
        if self.body.drive == "car":
            return max(abs(gait.speed or 0.0) for gait in self.gait)
        return max(abs((gait.left or 0.0) + (gait.right or 0.0)) / 2 for gait in self.gait)

    @property
    def gaits(self) -> GaitRepertoire:
        """The gaits as the models' repertoire."""
        first, second = _COMMAND_KEYS[self.body.drive]
        gaits = tuple(Gait(g.name, (getattr(g, first), getattr(g, second))) for g in self.gait)
        return GaitRepertoire(gaits, self.body.diameter, self.gait_duration)


class PreySettings(Settings):
    """A prey: a differential-drive disc and the behaviour that steers it."""

    behaviour: str = Field("braitenberg", description="braitenberg, straight, random_walk, evader or a registered one")
    senses_hunter: bool = Field(False, description="whether its proximity sensors see the hunter")
    speed: NonNegative = Field(0.048, description="free speed [m/s]")
    sensor_range: Positive = Field(0.05, description="proximity sensor range [m]")
    sensor_noise: Share = Field(0.01, description="relative standard deviation of a sensor value [share]")
    turn_sd: NonNegative = Field(0.8, description="sd of the turning rate of a random walk [rad/s]")
    turn_time: Positive = Field(1.0, description="time constant of the turning rate of a random walk [s]")
    flee_distance: Positive = Field(4.0, description="an evader turns away when the hunter is nearer [body lengths]")
    turn_rate: Positive = Field(0.8, description="how fast an evader turns [rad/s]")
    body: BodySettings = Field(default_factory=BodySettings)
    noise: NoiseSettings = Field(default_factory=NoiseSettings)

    @model_validator(mode="after")
    def _differential(self) -> PreySettings:
        if self.body.drive != "differential":
            raise ValueError("a prey's body.drive must be 'differential'")
        return self


class ArenaSettings(Settings):
    """The arena: open, or a walled rectangle centred on the origin."""

    walled: bool = Field(False, description="whether there are walls")
    width: Positive = Field(1.2, description="inner size along x [m]")
    height: Positive = Field(1.2, description="inner size along y [m]")


class PhysicsSettings(Settings):
    """How Box2D advances time."""

    step: Annotated[float, Field(gt=0, le=0.2)] = Field(0.032, description="physics step [s]")
    velocity_iterations: Annotated[int, Field(ge=1, le=100)] = Field(6, description="of Box2D's solver")
    position_iterations: Annotated[int, Field(ge=1, le=100)] = Field(2, description="of Box2D's solver")
    control_steps: Annotated[int, Field(ge=1, le=1000)] = Field(
        2, description="physics steps per control interval: prey control and noise"
    )

    @property
    def control_interval(self) -> float:
        """Seconds between two decisions of the prey's controller and two draws of noise."""
        return self.step * self.control_steps

    def steps(self, duration: float) -> int:
        """Number of physics steps in ``duration`` [s], at least one."""
        return max(1, round(duration / self.step))


class ProtocolSettings(Settings):
    """The experiment of the paper (section 4): where the prey starts, how long, how often."""

    thetas: tuple[Finite, ...] = Field(
        (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0), min_length=1, description="prey bearings, clockwise [rad]"
    )
    runs: Annotated[int, Field(ge=1, le=10_000_000)] = Field(100, description="runs per bearing")
    prey_distance: Positive = Field(5.0, description="first distance of the prey [body lengths]")
    time_limit: Positive = Field(60.0, description="a run without a catch ends here [s]")
    catch_distance: Positive = Field(1.02, description="centre distance that counts as a catch [body lengths]")

    @field_validator("thetas")
    @classmethod
    def _in_radians(cls, thetas: tuple[float, ...]) -> tuple[float, ...]:
        for theta in thetas:
            if abs(theta) > FULL_TURN:
                raise ValueError(beyond_a_turn(theta))
        return thetas


class ModelSettings(Settings):
    """Bins and prior of the models."""

    prior: NonNegative = Field(0.0, description="Dirichlet pseudo-count per cell; 0 is maximum likelihood")
    distance_bin: Positive = Field(0.1, description="distance bin width [body lengths]")
    angle_bins: Annotated[int, Field(ge=1, le=3600)] = Field(36, description="bins of the full turn")
    heading_bins: Annotated[int, Field(ge=1, le=3600)] = Field(36, description="bins of the full turn")
    babbling_steps: Annotated[int, Field(ge=1, le=1_000_000_000)] = Field(2000, description="gaits babbled")


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
            raise ConfigError(f"unknown arena {name!r}; expected one of {', '.join(self.arenas)}")
        arena = self.arenas[name]
        reach = self.protocol.prey_distance * self.robot.body.diameter + 0.5 * self.prey.body.diameter
        if arena.walled and reach > 0.5 * min(arena.width, arena.height):
            raise ConfigError(
                f"settings {self.name!r}: arenas.{name}.width and height: the prey would start in a wall; "
                f"make both larger than {2 * reach:.3f} m"
            )
