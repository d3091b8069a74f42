"""What the hunter perceives: by which sensor, and what turns that into a belief."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from bayeshunt.config.schema.groups import Settings

__all__ = ["SensingSettings"]


class SensingSettings(Settings):
    """A sensor and a tracker. By default the hunter is told both poses."""

    sensor: str = Field("exact", min_length=1, description="exact or a registered sensor")
    tracker: str = Field("exact", min_length=1, description="exact or a registered tracker")
    sensor_settings: dict[str, Any] = Field(default_factory=dict, description="settings of a registered sensor")
    tracker_settings: dict[str, Any] = Field(default_factory=dict, description="settings of a registered tracker")
