"""What a command's own motion misses: poses beside those that the command asks for, and back.

A residual is the pose that came as seen from the pose that was asked for, turned to the middle of the arc: what slips
then points the same way at the start of a turn and at its end. Letters: N rows, G gaits, A actuators.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.data import babbling_table
from bayeshunt.data.logs import command_columns
from bayeshunt.models.counting.auto_axes import auto_axes
from bayeshunt.models.counting.previous import previous_codes
from bayeshunt.models.motion.unicycle import Unicycle

__all__ = ["UNICYCLE", "Residuals", "added", "missed", "with_commands"]

#: The motion whose residuals can be counted.
UNICYCLE = "unicycle"
_EFFECTS = ["distance", "angle", "heading"]


def missed(asked: Polar[FloatArray], came: Polar[FloatArray]) -> Polar[FloatArray]:
    """Return what came beside what was asked for: Polar of arrays."""
    gap = ((came.forward - asked.forward) + 1j * (came.right - asked.right)) * np.exp(-0.5j * asked.heading)
    return Polar.from_cartesian(gap.real, gap.imag, came.heading - asked.heading)


def added(asked: Polar[FloatArray], residual: Polar[FloatArray]) -> Polar[FloatArray]:
    """Return what comes where ``residual`` is missed beside what was asked for: undoes :func:`missed`."""
    gap = (residual.forward + 1j * residual.right) * np.exp(0.5j * asked.heading)
    return Polar.from_cartesian(asked.forward + gap.real, asked.right + gap.imag, asked.heading + residual.heading)


@dataclass(frozen=True)
class Residuals:
    """The motion that commands ask for, the gaits whose commands they are, and the bins of what it misses.

    motion: fitted to rows. gaits: each with its command. axes: bins of the residuals; as for poses, the distance grows.
    before: the gait before, where the motion lags and it is known.
    """

    motion: Unicycle
    gaits: GaitRepertoire
    axes: EffectAxes
    before: str | None = None

    @classmethod
    def fit(cls, frame: pd.DataFrame, gaits: GaitRepertoire, *, lags: bool = False) -> Residuals:
        """Fit the motion to a babbling table and choose bins for what it misses.

        lags: with the lag of what was commanded before; the table then says which gait went before each row.
        Raises DataError where a gait has no command, or there are too few rows.
        """
        outcomes = Polar(*(frame[name].to_numpy(dtype=float) for name in _EFFECTS))
        before = _before(frame, gaits) if lags else None
        made = cls(Unicycle.fit(_commands(frame, gaits), outcomes, before), gaits, EffectAxes.standard(1.0))
        return replace(made, axes=auto_axes(made.of(frame), gaits))

    def after(self, before: str | None) -> Residuals:
        """Return the same after one gait; None: not known."""
        return replace(self, before=before) if self.motion.lags else self

    def of_gait(self, gait: int, points: int = 1) -> Polar[FloatArray]:
        """Return the poses [points] after equal parts of one gait; the last is its end."""
        parts = np.arange(1, points + 1) / points
        told = np.array(self.gaits[gait].command)
        if self.before is None or not self.motion.lags:
            return self.motion.predict(parts[:, None] * told)
        before = np.array(self.gaits[self.gaits.index(self.before)].command)
        return self.motion.predict(np.tile(told, (points, 1)), np.tile(before, (points, 1)), parts)

    def of(self, frame: pd.DataFrame) -> pd.DataFrame:
        """Return a babbling table whose poses, part-way ones too, are what the motion of each row's command misses.

        A row's command is in its columns command_0, ...; in a table without them it is that of its gait.
        """
        commands, path = _commands(frame, self.gaits), babbling_table.path_columns(frame.columns)
        before = _before(frame, self.gaits) if self.motion.lags else None
        table = frame.copy()
        points = len(path) // 3 + 1
        for point in range(1, points):
            names = path[3 * point - 3 : 3 * point]
            came = Polar.from_cartesian(*(frame[name].to_numpy(dtype=float) for name in names))
            asked = (
                self.motion.predict(commands * (point / points))
                if before is None
                else self.motion.predict(commands, before, point / points)
            )
            gap = missed(asked, came)
            table[names] = np.column_stack([gap.forward, gap.right, gap.heading])
        end = missed(self.motion.predict(commands, before), Polar(*(frame[n].to_numpy(dtype=float) for n in _EFFECTS)))
        table[_EFFECTS] = np.column_stack(end)
        return table


def with_commands(gaits: GaitRepertoire, frame: pd.DataFrame, known: GaitRepertoire | None = None) -> GaitRepertoire:
    """Return the repertoire with a command for every gait.

    A gait that has none takes that of ``known`` (the gaits of the table's record), else the mean of its rows' columns
    command_0, ... Raises DataError for a gait that has none anywhere, InputError for commands of several lengths.
    """
    columns = command_columns(frame.columns)
    means = frame.groupby(frame["gait"].astype(str))[columns].mean() if columns else pd.DataFrame()
    recorded = {gait.name: gait.command for gait in known or () if gait.command}

    def command(gait: Gait) -> tuple[float, ...]:
        if found := gait.command or recorded.get(gait.name, ()):
            return found
        if gait.name not in means.index:
            raise DataError(
                f"gait {gait.name!r} has no command, and residuals need one; give Gait(name, command), or columns "
                "command_0, ... of the table"
            )
        return tuple(map(float, means.loc[[gait.name]].to_numpy()[0]))

    made = tuple(Gait(gait.name, command(gait)) for gait in gaits)
    if len(lengths := {len(gait.command) for gait in made}) > 1:
        raise InputError(f"residuals need commands of one length; the gaits have {sorted(lengths)} actuators")
    return GaitRepertoire(made, body_length=gaits.body_length, duration=gaits.duration)


def _before(frame: pd.DataFrame, gaits: GaitRepertoire) -> FloatArray:
    """Commands [N, A] of the gait before each row, NaN where none was: a row tells all, so that order never matters."""
    codes = previous_codes(frame, gaits)
    values: FloatArray = np.array([gait.command for gait in gaits])[np.maximum(codes, 0)]
    return np.where(codes[:, None] >= 0, values, np.nan)


def _commands(frame: pd.DataFrame, gaits: GaitRepertoire) -> FloatArray:
    """Commands [N, A] of the rows."""
    own: FloatArray = np.array([gait.command for gait in gaits])[babbling_table.gait_codes(frame["gait"], gaits)]
    columns = command_columns(frame.columns)
    if len(columns) != own.shape[1]:
        return own
    values: FloatArray = np.ascontiguousarray(frame[columns].to_numpy(dtype=float))  # sums round by layout
    if not np.isfinite(values).all():
        row = int(np.flatnonzero(~np.isfinite(values).all(axis=1))[0])
        raise DataError(f"table: row {row}: a command is not a finite number")
    return values
