"""The prey: a body and the behaviour that steers it."""

from __future__ import annotations

from pydantic import Field, model_validator

from bayeshunt.config.schema.bodies import BodySettings, NoiseSettings
from bayeshunt.config.schema.groups import NonNegative, Positive, Settings, Share

__all__ = ["PreySettings"]


class PreySettings(Settings):
    """A prey: a differential-drive disc and the behaviour that steers it."""

    behaviour: str = Field(
        "braitenberg", description="braitenberg, straight, random_walk, evader, recorded:FILE#ID or a registered one"
    )
    model: str = Field(
        "counts",
        min_length=1,
        description="what the hunter learns of it: counts, constant_velocity, a file of prey fit or a registered model",
    )
    senses_hunter: bool = Field(False, description="whether its proximity sensors see the hunter")
    speed: NonNegative = Field(0.048, description="free speed [m/s]")
    sensor_range: Positive = Field(0.05, description="proximity sensor range [m]")
    sensor_noise: Share = Field(0.01, description="relative standard deviation of a sensor value [share]")
    turn_sd: NonNegative = Field(0.8, description="sd of the turning rate of a random walk [rad/s]")
    turn_time: Positive = Field(1.0, description="time constant of the turning rate of a random walk [s]")
    flee_distance: Positive = Field(4.0, description="an evader turns away when the hunter is nearer [body lengths]")
    turn_rate: Positive = Field(0.8, description="how fast an evader turns [rad/s]")
    relative: bool = Field(
        False,
        description="whether speed is given as a share of the hunter's top speed, and sensor_range, body.diameter, "
        "body.axle and body.wheelbase in its body lengths",
    )
    body: BodySettings = Field(default_factory=BodySettings)
    noise: NoiseSettings = Field(default_factory=NoiseSettings)

    @model_validator(mode="after")
    def _differential(self) -> PreySettings:
        if self.body.drive != "differential":
            raise ValueError("a prey's body.drive must be 'differential'")
        return self
