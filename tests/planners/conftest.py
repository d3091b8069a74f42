"""Fitted models shared by the planners' tests."""

from __future__ import annotations

import pytest
from planner_cases import WHEELS, fit

from bayeshunt.models.body.forward import ForwardModel


@pytest.fixture(scope="session")
def model() -> ForwardModel:
    """All ten gaits."""
    return fit(list(WHEELS))


@pytest.fixture(scope="session")
def small_model() -> ForwardModel:
    """Three gaits: every sequence can be enumerated."""
    return fit(["straight", "spin right", "slow left"], rows=300)
