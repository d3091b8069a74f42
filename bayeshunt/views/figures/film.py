"""A hunt as a film: a GIF made with pillow, or an MP4 where ffmpeg is."""

from __future__ import annotations

import os
import shutil
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from bayeshunt.core.checks import check_positive
from bayeshunt.core.errors import InputError
from bayeshunt.episodes.episode import Episode
from bayeshunt.files.atomic import check_path, replace_atomically
from bayeshunt.views.figures.hunts import draw_place, path_of, reach_of
from bayeshunt.views.figures.style import HUNTER, PREY

__all__ = ["SPEED", "film"]

#: A film is so many times as fast as the hunt was, unless another speed is asked for.
SPEED = 4.0
_RATE = 12  # frames per second


def film(episode: Episode, path: str | os.PathLike[str], *, speed: float = SPEED) -> None:
    """Write a hunt seen from above as a film, replaced atomically.

    path: ends in ``.gif`` (made with pillow) or ``.mp4`` (needs ffmpeg). speed: so many times as fast as it was, > 0.

    Raises InputError for another ending, where ffmpeg is missing, or for a hunt without a decision.
    """
    check_positive(speed, "speed", "times as fast")
    target = Path(check_path(path, "the name of a film to write", InputError))
    (writer, program), frame = _writer(target), episode.frame
    if frame.empty:
        raise InputError("nothing to show: the hunt ended before its first decision")
    figure = Figure(figsize=(4.8, 4.8), dpi=100)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.88))
    axes.set_axis_off()
    settings = draw_place(axes, episode, reach_of([episode]))
    radii = {"prey": settings.prey.body.diameter, "hunter": settings.robot.body.body_length}
    moving: dict[str, Any] = {}
    for who, colour in (("prey", PREY), ("hunter", HUNTER)):
        (line,) = axes.plot([], [], color=colour, linewidth=1.8)
        moving[who] = (line, axes.add_patch(Circle((0, 0), 500 * radii[who], color=colour)), path_of(episode, who))
    times = np.concatenate([[0.0], episode.trail["time"].to_numpy()])
    title = figure.text(0.03, 0.94, "", fontsize=10)
    planner, gaits, starts = episode.provenance["planner"], frame["gait"].tolist(), frame["time"].to_numpy()
    shown = np.append(np.arange(0.0, times[-1], speed / _RATE), [times[-1]] * _RATE)  # the end stays for a second
    with mpl.rc_context(program), replace_atomically(target) as temporary:
        named = temporary.with_suffix(target.suffix.lower())
        try:
            with writer.saving(figure, str(named), 100):
                for now in shown.tolist():
                    for line, disc, track in moving.values():
                        x, y = (np.interp(now, times, part) for part in track.T)
                        upto = track[times <= now]
                        line.set_data([*upto[:, 0], x], [*upto[:, 1], y])
                        disc.center = (x, y)
                    gait = gaits[max(0, int(np.searchsorted(starts, now + 1e-9)) - 1)]
                    end = " caught" if episode.caught and now >= times[-1] else ""
                    title.set_text(f"{planner}   {now:5.1f} s   {gait}{end}")
                    writer.grab_frame()
            named.replace(temporary)
        finally:
            named.unlink(missing_ok=True)


def _writer(target: Path) -> tuple[Any, Any]:
    """What writes a film of this name, and the setting of matplotlib that it needs while it does."""
    kind = target.suffix.lower()
    if kind == ".gif":
        return PillowWriter(fps=_RATE), {}
    if kind != ".mp4":
        raise InputError(f"{target}: expected a film's name that ends in .gif or .mp4")
    program = shutil.which("ffmpeg")
    if program is None and find_spec("imageio_ffmpeg") is not None:
        import imageio_ffmpeg

        program = imageio_ffmpeg.get_ffmpeg_exe()
    if program is None:
        raise InputError(f"{target}: an MP4 needs ffmpeg, which is not installed; name it {target.with_suffix('.gif')}")
    return FFMpegWriter(fps=_RATE), {"animation.ffmpeg_path": program}
