"""What many tests share: one small babbling table and the model fitted to it."""

import pytest

from bayeshunt.models.forward import ForwardModel
from bayeshunt.settings import load_robot
from bayeshunt.world.babbling import babble


@pytest.fixture(scope="session")
def khepera_frame():
    """400 babbled gaits of the Khepera."""
    return babble("khepera", 400, 0)


@pytest.fixture(scope="session")
def khepera_model(khepera_frame):
    """The forward model of those."""
    return ForwardModel.fit(khepera_frame, load_robot("khepera").gaits)
