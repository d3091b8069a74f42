"""Two time-steps ahead of a prey that reacts: what it does in the second depends on where the first gait leads.

Letters: G gaits, P part-way poses of a gait, K motions of the prey in the first step, J in the second.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bayeshunt.core.geometry import FloatArray, Polar, wrap
from bayeshunt.models.target.reactions import Reactions
from bayeshunt.planners.interception.homing import CHASE_SHARE, Homing
from bayeshunt.planners.interception.lookahead import Charge, Outlook, PairPaths, chance_within, keep_highest

__all__ = ["Reacting", "look_ahead_of_reactions"]

#: Motions that are told apart in each step, the likeliest.
_MOST = 8
#: What a prey that turns gets away from its hunter, as a share of its speed, beyond both steps.
_AWAY = 0.8


@dataclass(frozen=True, eq=False)
class Reacting:
    """What every pair of gaits is expected to bring.

    first: P(the prey's motion in the first step) [K]. second: that in the second [G, K, J], given the first gait and
    the first motion. time: expected seconds to the capture of each pair [G, G, K, J]. prey: complex places forward + i
    right now and at the end of both steps, and its headings [rad clockwise]: the likeliest of every first gait [G, 3].
    """

    first: FloatArray
    second: FloatArray
    time: FloatArray
    prey: tuple[np.ndarray, FloatArray]

    def decide(self) -> tuple[FloatArray, FloatArray]:
        """Return the expected time [s] of every first gait [G], and of every pair when nothing new is seen [G, G].

        The hunter sees what the prey did in the first step, and picks the best second gait for it.
        """
        values = np.einsum("ghkj,gkj->ghk", self.time, self.second)
        return values.min(axis=1) @ self.first, values @ self.first


def look_ahead_of_reactions(
    pairs: PairPaths, prey: Polar, table: Reactions, homing: Homing, spread: float, charge: Charge | None = None
) -> Reacting:
    """Value every pair of gaits against a prey that does what ``table`` says, given where the hunter then is.

    The time to the capture is as in :func:`~bayeshunt.planners.interception.lookahead.look_ahead`; beyond both steps
    the prey makes off, and what is left is the gap at the speed by which the hunter closes it, and the price of turning
    to where the prey is. prey: as the hunter sees it now. charge: what is charged beside the time.
    """
    motions, duration = table.motions, pairs.times[-1] / 2
    paths = _arcs(motions, pairs.first.shape[2])
    start, facing = prey.distance * np.exp(1j * prey.angle), float(prey.heading)
    before = _chances(table, np.array(-start * np.exp(-1j * facing)))
    kept = _likeliest(before)
    first = before[kept] / before[kept].sum()
    one = start + paths[kept] * np.exp(1j * facing)  # [K, P]
    turned = facing + motions.heading[kept]
    ends = pairs.first_end[0, :, 0] + 1j * pairs.first_end[1, :, 0]
    after = _chances(table, (ends[:, None] - one[:, -1]) * np.exp(-1j * turned))  # [G, K, J]
    some = _likeliest((after * first[:, None]).sum(axis=(0, 1)))
    second = after[..., some] / np.maximum(after[..., some].sum(axis=2, keepdims=True), 1e-12)
    two = one[:, -1, None, None] + paths[some] * np.exp(1j * turned)[:, None, None]  # [K, J, P]
    pace = min(_AWAY * float(table.everywhere @ motions.distance) / duration, CHASE_SHARE * homing.top_speed)
    outlook = _outlook(pairs, one, two.reshape(-1, two.shape[2]), homing, spread, pace)
    time = outlook.time if charge is None else charge(outlook).time
    likely = second[:, first.argmax()].argmax(axis=1)  # [G]
    now = int(first.argmax())
    places = np.stack([np.full(len(ends), p) for p in (start, one[now, -1])] + [two[now, likely, -1]], axis=1)
    headings = np.stack(
        [np.full(len(ends), h) for h in (facing, turned[now])] + [turned[now] + motions.heading[some][likely]], axis=1
    )
    return Reacting(first, second, time.reshape(*time.shape[:2], len(kept), len(some)), (places, headings))


def _outlook(pairs: PairPaths, one: np.ndarray, two: np.ndarray, homing: Homing, spread: float, pace: float) -> Outlook:
    """What pairs of gaits bring in each of K J futures: a prey on the paths ``one`` [K, P], then ``two`` [K J, P]."""
    points, each = one.shape[1], len(two) // len(one)
    first = chance_within(pairs.first, one.real.T, one.imag.T, homing.reach, spread)
    second = chance_within(pairs.second, two.real.T, two.imag.T, homing.reach, spread)
    keep_highest(first)
    first = np.repeat(first, each, axis=-1)
    np.maximum(second[:, :, 0], first[:, None, -1], out=second[:, :, 0])
    keep_highest(second)
    during = pairs.times[0] * ((points - first.sum(axis=-2))[:, None] + (points - second.sum(axis=-2)))
    x, y, heading = pairs.end
    ahead, right = two[:, -1].real - x, two[:, -1].imag - y
    left = np.maximum(np.hypot(ahead, right) - homing.reach, 0.0) / (homing.top_speed - pace)
    left += homing.heading_price * np.abs(wrap(np.arctan2(right, ahead) - heading))
    return Outlook(first, second, during + (1.0 - second[:, :, -1]) * left)


def _chances(table: Reactions, hunter: np.ndarray) -> FloatArray:
    """P(motion) [..., J] with the hunter at complex places forward + i right of the prey [...]."""
    chance = table.chances(np.abs(hunter).ravel(), np.angle(hunter).ravel())
    return chance.reshape(*hunter.shape, -1)


def _likeliest(chance: FloatArray) -> np.ndarray:
    """Numbers of the likeliest motions, in order of their chance."""
    return np.argsort(-chance, kind="stable")[:_MOST]


def _arcs(motions: Polar[FloatArray], points: int) -> np.ndarray:
    """Complex places forward + i right [J, P] part-way through motions: on arcs, or straight where it is none."""
    share = np.arange(1, points + 1) / points
    angle = np.where(np.abs(motions.angle) > 1e-9, motions.angle, 1e-9)[:, None]
    arc = np.abs(angle) < 0.5 * np.pi  # beyond it a chord is no arc of less than a turn
    bent = np.sin(share * angle) / np.sin(np.where(arc, angle, 1.0)) * np.exp(1j * share * angle)
    paths: np.ndarray = motions.distance[:, None] * np.where(arc, bent, share * np.exp(1j * angle))
    return paths
