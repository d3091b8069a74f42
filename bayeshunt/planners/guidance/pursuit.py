"""Classical guidance with the robot's gaits: what a learned hunter has to beat.

All of them see what the other planners see and execute the same gaits; none needs the prey model.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bayeshunt.core.geometry import Polar, wrap
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Plan, Shown, Situation
from bayeshunt.planners.guidance.steering import Steering, intercept_time, prey_track
from bayeshunt.planners.requests import check_request
from bayeshunt.planners.settings import Number, planner_settings, setting

__all__ = ["ConstantVelocity", "NavigationSettings", "ProportionalNavigation", "PurePursuit", "VelocitySettings"]


class PurePursuit(Shown):
    """Drive at where the prey is now: the gait whose mean end is nearest to it.

    ``rng`` is not used.
    """

    name = "pure_pursuit"

    def __init__(self, model: ForwardModel) -> None:
        self.hunter = model.gaits
        self.steering = Steering(model)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the gait towards the prey's present position."""
        situation = check_request(situation, rng, self.hunter)
        prey, steering = situation.prey, self.steering.after(situation.previous_gait)
        return steering.towards(float(prey.forward), float(prey.right), heading=float(prey.heading))


@planner_settings("proportional_navigation")
class NavigationSettings:
    """Settings of proportional navigation."""

    navigation_constant: Number = setting(3.0, "N", gt=0)


class ProportionalNavigation(Shown):
    """Turn in proportion to the turning of the line of sight, so that the bearing stays constant.

    ``turn = N lambda' D``: navigation constant N, line-of-sight rate lambda' [rad/s], time-step D, where
    ``lambda' = (r x v) / |r|^2`` from the prey's position r and velocity v relative to the hunter at its
    top speed. The gait whose mean turn is nearest is executed, a slow one only if there is no fast one.
    The law assumes a prey ahead that comes closer: while it is more than a right angle off, or before
    its velocity has been seen, the hunter pursues it instead.

    Reference: P. Zarchan, Tactical and Strategic Missile Guidance, chapter 2. ``rng`` is not used.
    """

    name = "proportional_navigation"
    Settings = NavigationSettings

    def __init__(self, model: ForwardModel, settings: NavigationSettings | None = None, **given: Any) -> None:
        self.settings = NavigationSettings(**given) if settings is None else settings
        self.hunter = model.gaits
        self.steering = Steering(model)
        self._fast = _fast_gaits(self.steering)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the gait whose turn is nearest the one commanded."""
        situation = check_request(situation, rng, self.hunter)
        steering, prey = self.steering.after(situation.previous_gait), situation.prey
        ahead, right = float(prey.forward), float(prey.right)
        if not situation.transitions or abs(prey.angle) > 0.5 * math.pi:
            return steering.towards(ahead, right, heading=float(prey.heading))
        track, step = prey_track(situation), situation.need("time_step")
        v_ahead = float(track.forward[-1] - track.forward[-2]) / step - self.steering.top_speed
        v_right = float(track.right[-1] - track.right[-2]) / step
        rate = (ahead * v_right - right * v_ahead) / max(ahead * ahead + right * right, 1e-12)
        turn = self.settings.navigation_constant * rate * step
        turn = max(-math.pi, min(math.pi, turn))
        miss = np.abs(np.asarray(wrap(steering.heading - turn)))
        miss = np.where(self._fast, miss, miss + math.pi)
        return steering.plan(miss, "difference from the turn commanded [rad]", Polar(*map(float, prey)), True)


def _fast_gaits(steering: Steering) -> np.ndarray:
    """Return the gaits that drive nearly as far as the fastest along their arcs, bool [G]: all but the slow ones."""
    chord, half = np.hypot(steering.forward, steering.right), 0.5 * np.abs(steering.heading)
    arcs = chord * half / np.sin(np.maximum(half, 1e-9))
    found: np.ndarray = np.where(half > 1e-9, np.abs(arcs), chord) >= 0.6 * steering.reach
    return found


@planner_settings("constant_velocity")
class VelocitySettings:
    """Settings of the Kalman filter."""

    acceleration: Number = setting(0.003, "standard deviation of the prey's white acceleration [m/s2]", gt=0)
    position: Number = setting(0.002, "standard deviation of an observed position [m]", gt=0)


class ConstantVelocity(Shown):
    """Meet a prey that keeps its velocity: interception at the velocity that a Kalman filter estimates.

    State (position, velocity) in the plane, position observed once per time-step; pykalman filters the
    whole track at every decision, as a planner keeps no state. The hunter aims at the point where a
    straight drive at top speed meets the prey, at the earliest the end of the step. Before
    anything is seen the prey's velocity has mean 0 and standard deviation the hunter's own top speed.

    Reference: R. E. Kalman, A new approach to linear filtering and prediction problems, 1960. ``rng`` is not used.
    """

    name = "constant_velocity"
    Settings = VelocitySettings

    def __init__(self, model: ForwardModel, settings: VelocitySettings | None = None, **given: Any) -> None:
        self.settings = VelocitySettings(**given) if settings is None else settings
        self.hunter = model.gaits
        self.steering = Steering(model)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the gait towards the point of interception."""
        situation = check_request(situation, rng, self.hunter)
        steering = self.steering.after(situation.previous_gait)
        if not situation.transitions:
            prey = situation.prey
            return steering.towards(float(prey.forward), float(prey.right), heading=float(prey.heading))
        ahead, right, v_ahead, v_right = self._estimate(situation)
        reach, step = situation.need("body_length"), situation.need("time_step")
        time = intercept_time(ahead, right, v_ahead, v_right, self.steering.top_speed, reach)
        # a gait is held for a whole step, so a point that is passed before the step ends is no aim
        time = max(time, step) if math.isfinite(time) else step
        return steering.towards(ahead + v_ahead * time, right + v_right * time, prey_known=True)

    def _estimate(self, situation: Situation) -> tuple[float, float, float, float]:
        """Return the filtered position [m] and velocity [m/s] of the prey: ahead, right, and their rates."""
        from pykalman import KalmanFilter

        step, speed = situation.need("time_step"), self.steering.top_speed
        track = prey_track(situation)
        seen = np.column_stack([track.forward, track.right])
        move = np.kron([[1.0, step], [0.0, 1.0]], np.eye(2))
        # a velocity that wanders by white acceleration held over one step
        wander = self.settings.acceleration
        push = np.kron(np.outer([0.5 * step**2, step], [0.5 * step**2, step]), np.eye(2)) * wander**2
        kalman = KalmanFilter(
            transition_matrices=move,
            observation_matrices=np.eye(2, 4),
            transition_covariance=push,
            observation_covariance=self.settings.position**2 * np.eye(2),
            initial_state_mean=np.array([*seen[0], 0.0, 0.0]),
            initial_state_covariance=np.diag([self.settings.position**2] * 2 + [speed**2] * 2),
        )
        means, _ = kalman.filter(seen)
        ahead, right, v_ahead, v_right = (float(value) for value in means[-1])
        return ahead, right, v_ahead, v_right
