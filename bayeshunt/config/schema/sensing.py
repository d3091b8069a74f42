"""What the hunter perceives: by which sensor, and what turns that into a belief."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from bayeshunt.config.schema.camera import CAMERAS, CameraSettings
from bayeshunt.config.schema.groups import Settings
from bayeshunt.core.errors import did_you_mean

__all__ = ["SensingSettings"]

_CAMERA, _TRACKER = "camera", "particles"


class SensingSettings(Settings):
    """A sensor and a tracker. By default the hunter is told both poses."""

    preset: str = Field(
        "", description="a camera that ships: camera_wide, camera_narrow, camera_omni or camera_k213; empty: none"
    )
    sensor: str = Field("exact", min_length=1, description="exact, camera or a registered sensor")
    tracker: str = Field(
        "exact",
        min_length=1,
        description="exact, particles, kalman or a registered tracker; with a camera particles where none is given",
    )
    start: Literal["shown", "unknown"] = Field(
        "shown", description="whether a camera is shown the prey once at the start, wherever it is"
    )
    camera: CameraSettings = Field(default_factory=CameraSettings, description="of the sensor camera")
    sensor_settings: dict[str, Any] = Field(default_factory=dict, description="settings of a registered sensor")
    tracker_settings: dict[str, Any] = Field(
        default_factory=dict, description="settings of the tracker particles or of a registered one"
    )

    @property
    def seen_by(self) -> CameraSettings | None:
        """The camera of what is perceived with one; None with another sensor."""
        return self.camera if self.sensor == _CAMERA else None

    @model_validator(mode="before")
    @classmethod
    def _from_preset(cls, values: Any) -> Any:
        """Fill in what a preset says and nobody has said otherwise."""
        if not isinstance(values, dict):
            return values
        values = dict(values)
        preset = values.get("preset", "")
        if preset:
            if preset not in CAMERAS:
                raise ValueError(f"preset: unknown camera {preset!r}{did_you_mean(str(preset), sorted(CAMERAS))}")
            values.setdefault("sensor", _CAMERA)
            given = values.get("camera", {})
            if isinstance(given, dict):
                values["camera"] = {**CAMERAS[preset], **given}
        if values.get("sensor") == _CAMERA:
            values.setdefault("tracker", _TRACKER)
        return values
