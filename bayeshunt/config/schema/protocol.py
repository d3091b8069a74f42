"""How an experiment runs: how physics advances, where the prey starts, how long and how often."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from bayeshunt.config.schema.groups import Finite, NonNegative, Positive, Settings
from bayeshunt.core.checks import FULL_TURN, beyond_a_turn
from bayeshunt.core.geometry import Pose
from bayeshunt.core.task import CATCH_BODIES

__all__ = ["PhysicsSettings", "ProtocolSettings"]


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
    catch_distance: Positive = Field(CATCH_BODIES, description="centre distance that counts as a catch [body lengths]")
    hunter_x: Finite = Field(0.0, description="where the hunter starts, from the arena's centre along x [m]")
    hunter_y: Finite = Field(0.0, description="where the hunter starts, from the arena's centre along y [m]")
    hunter_theta: Finite = Field(0.0, description="where it faces at the start, counter-clockwise from x [rad]")

    thinking: Literal["free", "nodes"] = Field(
        "free", description="whether the world waits while the hunter thinks, or goes on for every node that it weighs"
    )
    seconds_per_node: NonNegative = Field(
        0.002, description="with thinking by nodes: how long the gait before is held for each node weighed [s]"
    )

    @field_validator("hunter_theta")
    @classmethod
    def _heading_in_radians(cls, theta: float) -> float:
        if abs(theta) > FULL_TURN:
            raise ValueError(beyond_a_turn(theta))
        return theta

    @property
    def hunter_pose(self) -> Pose:
        """Where the hunter starts, in the arena's frame."""
        return Pose(self.hunter_x, self.hunter_y, self.hunter_theta)

    @field_validator("thetas")
    @classmethod
    def _in_radians(cls, thetas: tuple[float, ...]) -> tuple[float, ...]:
        for theta in thetas:
            if abs(theta) > FULL_TURN:
                raise ValueError(beyond_a_turn(theta))
        return thetas
