"""A fitted model shared by the models' tests."""

from __future__ import annotations

import pandas as pd
import pytest
from model_cases import babbled, repertoire

from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel


@pytest.fixture(scope="session")
def frame() -> pd.DataFrame:
    return babbled(800, seed=1, points=3)


@pytest.fixture(scope="session")
def model(frame: pd.DataFrame) -> ForwardModel:
    return ForwardModel.fit(frame, repertoire())


@pytest.fixture(scope="session")
def inverse(model: ForwardModel) -> InverseModel:
    return InverseModel(model)
