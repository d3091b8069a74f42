"""The hunter's camera: what it sees of the prey, how well, and how well the hunter knows where it looks from."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import Field

from bayeshunt.config.schema.groups import NonNegative, Positive, Settings, Share
from bayeshunt.core.geometry import Polar
from bayeshunt.core.messages import Detection

__all__ = ["CAMERAS", "CameraSettings"]

#: A flat image cannot show this much; from here on pixels are spread evenly over the angle, as a mirror does.
_FLAT_LIMIT_DEG = 170.0


class CameraSettings(Settings):
    """A camera on the hunter that sees the prey as a disc of known width: its bearing and its apparent width.

    The defaults are those of ``camera_wide``.
    """

    fov_deg: Annotated[float, Field(gt=0, le=360)] = Field(120.0, description="horizontal field of view [deg]")
    pixels: Annotated[int, Field(ge=8, le=100_000)] = Field(640, description="pixels across the field of view")
    frames: Annotated[int, Field(ge=1, le=1000)] = Field(
        4, description="looks per time-step, each from where the hunter then is"
    )
    detection: Annotated[float, Field(gt=0, le=1)] = Field(
        0.95, description="probability that a prey in view is found in a frame"
    )
    clutter: Annotated[float, Field(ge=0, le=100)] = Field(0.02, description="false detections per frame, on average")
    clutter_range: Positive = Field(1.2, description="how far away false detections seem [m]")
    pixel_noise: NonNegative = Field(
        0.7, description="standard deviation of the apparent width, and of a place in the image [pixels]"
    )
    bearing_noise_deg: Annotated[float, Field(ge=0, le=90)] = Field(
        1.0, description="standard deviation of the bearing, beside that of the pixels [deg]"
    )
    heading_noise_deg: Annotated[float, Field(gt=0, le=180)] | None = Field(
        None, description="standard deviation of the prey's heading [deg]; not given: its heading is not seen"
    )
    least_pixels: Positive = Field(3.0, description="a prey that seems narrower is not found [pixels]")
    range: Positive | None = Field(None, description="and none that is farther away [m]")
    target_width: Positive | None = Field(None, description="width of the prey [m]; not given: its body's diameter")
    distance_error: Share = Field(0.0, description="of the hunter's odometry, per time-step: share of the way [share]")
    turn_error: Share = Field(0.0, description="of the hunter's odometry, per time-step: share of the turn [share]")

    @property
    def fov(self) -> float:
        """Field of view [rad]."""
        return math.radians(self.fov_deg)

    @property
    def focal(self) -> float:
        """Pixels per radian in the middle of the image: a flat image, or from 170 deg on an even one."""
        if self.fov_deg >= _FLAT_LIMIT_DEG:
            return self.pixels / self.fov
        return self.pixels / (2.0 * math.tan(0.5 * self.fov))

    @property
    def bearing_sd(self) -> float:
        """Standard deviation of a bearing [rad]."""
        return math.hypot(math.radians(self.bearing_noise_deg), self.pixel_noise / self.focal)

    @property
    def heading_sd(self) -> float | None:
        """Standard deviation of a heading [rad]; None: not seen."""
        return None if self.heading_noise_deg is None else math.radians(self.heading_noise_deg)

    def inverse_sd(self, width: float) -> float:
        """Standard deviation of the inverse of a distance [1/m] to a prey ``width`` [m] wide."""
        return self.pixel_noise / (self.focal * width)

    def reach(self, width: float) -> float:
        """Distance [m] up to which a prey ``width`` [m] wide is found."""
        by_size = self.focal * width / self.least_pixels
        return by_size if self.range is None else min(by_size, self.range)

    def in_view(self, seen: Polar[Any], width: float) -> Any:
        """Whether a prey ``width`` [m] wide, ``seen`` from here, is in view, hidden or not: bool or array of them."""
        return (abs(seen.angle) <= 0.5 * self.fov) & (seen.distance <= self.reach(width))

    def detection_of(
        self, bearing: float, *, width_px: float | None = None, distance: float | None = None,
        heading: float = math.nan, width: float | None = None,
    ) -> Detection:  # fmt: skip
        """Return a sighting of one's own as a detection, with this camera's standard deviations.

        bearing: radians clockwise from the hunter's heading. width_px: apparent width [pixels]; or distance [m]; with
        neither only the bearing is known. heading: of the prey [rad, clockwise from the hunter's], NaN if not seen.
        width: the prey's real width [m], by default ``target_width``.
        """
        real = self.target_width if width is None else width
        if distance is None:
            known = width_px is not None and real is not None
            distance = self.focal * float(real or 0.0) / max(float(width_px or 0.0), 1e-9) if known else math.nan
        spread = math.nan if real is None else distance**2 * self.inverse_sd(real)
        turn = math.nan if self.heading_sd is None else self.heading_sd
        return Detection(Polar(distance, bearing, heading), sd=Polar(spread, self.bearing_sd, turn))


#: Cameras by name: ``sensing.preset``. Where a number is of a product, its source is beside it.
CAMERAS: dict[str, dict[str, Any]] = {
    "camera_wide": {"fov_deg": 120.0, "pixels": 640},
    "camera_narrow": {"fov_deg": 60.0, "pixels": 160},
    "camera_omni": {"fov_deg": 360.0, "pixels": 640},
    # Webots, khepera_k213.wbt: fieldOfView 0.6283 rad, 64 pixels
    "camera_k213": {"fov_deg": 36.0, "pixels": 64},
}
