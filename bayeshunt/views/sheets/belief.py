"""The sheet of a belief: where the prey may be, as the hunter sees it, with what each place rests on."""

from __future__ import annotations

import math

import numpy as np

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.units import degrees, length
from bayeshunt.perception.trackers.particle_belief import ParticleBelief
from bayeshunt.views.drawings import maps, svg
from bayeshunt.views.notebook.html import Html, tag
from bayeshunt.views.sheets.sheet import Drawn, Note, Printed, Sheet, Table

__all__ = ["belief_map", "cell_names", "particle_belief"]

_DOTS = 400


def particle_belief(belief: ParticleBelief) -> Sheet:
    """Return a belief of particles: the polar table and its map."""
    place, camera = belief.own.relative(belief.mean), belief.eye.camera
    seen = "never" if math.isinf(belief.last_seen) else f"{belief.last_seen:.3g} s ago"
    facts = [
        ("expected", f"{length(place.distance)} at {degrees(place.angle)} clockwise, ± {length(belief.spread)}"),
        ("its heading", f"{degrees(place.heading)}, resultant {belief.resultant:.2f} (1: known, 0: any)"),
        ("last seen", f"{seen}; {belief.sightings} sightings in all"),
        ("P(in view now)", f"{belief.in_view():.3f}, field of view {camera.fov_deg:g}°"),
        ("believed of its motion", _motion(belief)),
    ]  # fmt: skip
    rows = [[*cell_names(cell), f"{cell[4]:.3f}", f"{cell[5]:.1f}"] for cell in belief.cells()]
    table = Table(["Distance", "Angle", "P", "sightings"], rows, words=frozenset({0, 1}))
    note = Note(
        "Sightings: how many the particles of a cell explain, on average; 0 is the motion model alone. "
        "Cells below half a percent are left out; belief.table() has them all."
    )
    subtitle = f"{len(belief.cloud)} particles, {belief.time:.1f} s into the hunt, as the hunter sees it"
    return Sheet(
        "Belief: P(prey in cell)", subtitle,
        facts, [Drawn(lambda: belief_map(belief), table, beside=True), Printed(table.lines), note],
    )  # fmt: skip


def cell_names(cell: list[float]) -> tuple[str, str]:
    """Return ring and sector of a cell in words."""
    near, far, start, end = cell[:4]
    ring = f"over {length(near)}" if math.isinf(far) else f"{1000 * near:g} to {length(far)}"
    return ring, f"{math.degrees(start):.0f} to {degrees(end)}".replace("-", "\N{MINUS SIGN}")


def belief_map(belief: ParticleBelief) -> Html:
    """Return the particles, the hunter and what its camera sees, the hunter's heading up."""
    seen = belief.seen()
    chosen = np.linspace(0, len(belief.cloud) - 1, min(_DOTS, len(belief.cloud))).astype(int)
    right, ahead = seen.right[chosen], seen.forward[chosen]
    weight = belief.cloud.weight[chosen]
    window = maps.Window.around([0.0, *right], [0.0, *ahead], size=300, least=0.2)
    parts = [_view(window, belief.eye.camera, belief.eye.camera.reach(belief.eye.width))]
    for x, y, w in zip(right, ahead, weight / weight.max(), strict=True):
        parts.append(svg.disc(*window.at(x, y), 1.4, fill=svg.PREY, fill_opacity=f"{0.15 + 0.5 * w:.2f}"))
    mean = belief.own.relative(belief.mean)
    parts.append(
        window.robot(mean.right, mean.forward, math.pi / 2 - mean.heading, svg.PREY, "the mean of the belief", 9)
    )
    parts.append(window.robot(0.0, 0.0, math.pi / 2, svg.HUNTER, "the hunter", 9))
    return svg.drawing(window.width, window.height, *parts, window.ruler(), label="Where the prey may be")


def _view(window: maps.Window, camera: CameraSettings, reach: float) -> Html:
    """The field of view as a wedge, clipped to the drawing."""
    shown = min(reach, 2.0 * max(window.width, window.height) / window.scale)
    half = 0.5 * camera.fov
    arc = [window.at(shown * math.sin(a), shown * math.cos(a)) for a in np.linspace(-half, half, 61)]
    corners = arc if camera.fov_deg >= 360.0 else [window.at(0.0, 0.0), *arc]
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    return tag("polygon", tag("title", "field of view"), points=points, fill=svg.HUNTER, fill_opacity="0.08")


def _motion(belief: ParticleBelief) -> str:
    motion = belief.motion
    return (
        f"{length(motion.speed)} a second, turns in {motion.hazard:.3f} of its time-steps, stands with probability "
        f"{motion.still_share:.2f}; learned from {motion.steps:.0f} time-steps"
    )
