"""One instant of a hunt as pixels, by pygame."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from gymnasium.error import DependencyNotInstalled
from numpy.typing import NDArray

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Moment

__all__ = ["SIZE", "Canvas"]

#: Pixels of a side of a frame.
SIZE = 400
_GROUND, _GRID, _WALL, _LINE = (250, 250, 247), (226, 226, 222), (60, 60, 60), (255, 255, 255)
_HUNTER, _PREY = (0, 114, 178), (213, 94, 0)
#: What is left free around an arena, or around the two robots in the open, as a share of it.
_MARGIN = 0.08
#: Metres between two lines on the ground, by which one sees robots move in the open.
_MESH = 0.2


class Canvas:
    """What a hunt is drawn on; with ``window``, on the screen too."""

    def __init__(self, settings: ExperimentSettings, arena: str, *, window: bool) -> None:
        try:
            import pygame
        except ImportError as error:
            raise DependencyNotInstalled(
                'pygame is not installed, run `pip install ".[gym]"` in the folder of bayeshunt'
            ) from error
        self._pygame: Any = pygame
        self._arena = settings.arenas[arena]
        self._radii = {
            "prey": (0.5 * settings.prey.body.diameter, _PREY), "hunter": (0.5 * settings.robot.body.diameter, _HUNTER)
        }  # fmt: skip
        self._window = window
        if window:
            pygame.display.init()
            self._surface: Any = pygame.display.set_mode((SIZE, SIZE))
            pygame.display.set_caption(f"bayeshunt: {settings.name}, {arena}")
            self._clock = pygame.time.Clock()
        else:
            self._surface = pygame.Surface((SIZE, SIZE))
        self._scale, self._centre = 1.0, (0.0, 0.0)

    def draw(self, moment: Moment) -> None:
        """Draw both robots where they are at this moment, in their arena."""
        self._look_at(moment)
        self._surface.fill(_GROUND)
        self._draw_ground()
        if self._arena.walled:
            width, height = self._arena.width, self._arena.height
            left, top = self._pixel(-0.5 * width, 0.5 * height)
            size = round(width * self._scale), round(height * self._scale)
            self._pygame.draw.rect(self._surface, _WALL, ((left, top), size), width=3)
        for obstacle in self._arena.obstacles:
            self._pygame.draw.polygon(self._surface, _WALL, [self._pixel(*at) for at in obstacle.outline()])
        for name, (radius, colour) in self._radii.items():
            self._draw_robot(moment.poses[name], radius, colour)

    def frame(self) -> NDArray[np.uint8]:
        """Return what is drawn: [SIZE, SIZE, 3]."""
        return np.transpose(self._pygame.surfarray.array3d(self._surface), (1, 0, 2)).copy()

    def flip(self, fps: float) -> None:
        """Put what is drawn on the screen, not before the frame's time has come."""
        self._pygame.event.pump()
        self._clock.tick(fps)
        self._pygame.display.flip()

    def close(self) -> None:
        """Close the window."""
        if self._window:
            self._pygame.display.quit()

    def _look_at(self, moment: Moment) -> None:
        """Choose the part of the plane that is drawn: the walled arena, or what holds both robots."""
        if self._arena.walled:
            across, self._centre = max(self._arena.width, self._arena.height), (0.0, 0.0)
        else:
            hunter, prey = moment.poses["hunter"], moment.poses["prey"]
            self._centre = 0.5 * (hunter.x + prey.x), 0.5 * (hunter.y + prey.y)
            apart = max(abs(hunter.x - prey.x), abs(hunter.y - prey.y))
            across = max(2.0, apart + 4.0 * self._radii["hunter"][0])
        self._scale = SIZE / (across * (1.0 + 2.0 * _MARGIN))

    def _pixel(self, x: float, y: float) -> tuple[int, int]:
        return (
            round(0.5 * SIZE + (x - self._centre[0]) * self._scale),
            round(0.5 * SIZE - (y - self._centre[1]) * self._scale),
        )

    def _draw_ground(self) -> None:
        half = 0.5 * SIZE / self._scale
        for axis, middle in enumerate(self._centre):
            for n in range(math.ceil((middle - half) / _MESH), math.floor((middle + half) / _MESH) + 1):
                at = self._pixel(n * _MESH, n * _MESH)[axis]
                ends = ((at, 0), (at, SIZE)) if axis == 0 else ((0, at), (SIZE, at))
                self._pygame.draw.line(self._surface, _GRID, *ends)

    def _draw_robot(self, pose: Pose, radius: float, colour: tuple[int, int, int]) -> None:
        pixels = max(3, round(radius * self._scale))
        self._pygame.draw.circle(self._surface, colour, self._pixel(pose.x, pose.y), pixels)
        nose = self._pixel(pose.x + radius * math.cos(pose.theta), pose.y + radius * math.sin(pose.theta))
        self._pygame.draw.line(self._surface, _LINE, self._pixel(pose.x, pose.y), nose, width=2)
