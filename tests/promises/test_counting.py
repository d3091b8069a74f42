"""10,000 one-row updates equal the batch, in any order and any split: forward model and prey model."""

import numpy as np
import pytest
from model_cases import babbled, repertoire

from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.target.prey import PreyModel

pytestmark = pytest.mark.slow

ROWS = 10_000


def test_forward_models(figure):
    frame = babbled(ROWS, 5, points=3)
    batch = ForwardModel.fit(frame, repertoire(), prior=0.5)
    rng = np.random.default_rng(0)
    model = ForwardModel.empty(repertoire(), 0.5)
    shuffled = frame.iloc[rng.permutation(ROWS)]
    for row in range(ROWS):
        model = model.update(shuffled.iloc[row : row + 1])
    assert model == batch
    splits = 50
    for _ in range(splits):
        order = frame.iloc[rng.permutation(ROWS)]
        cuts = np.sort(rng.integers(0, ROWS, int(rng.integers(1, 40))))
        parts = [JointCounts.of(order.iloc[a:b], batch.gaits, batch.axes)
                 for a, b in zip([0, *cuts], [*cuts, ROWS], strict=True) if b > a]  # fmt: skip
        while len(parts) > 1:  # merged in any order too
            one, two = (parts.pop(int(rng.integers(len(parts)))) for _ in range(2))
            parts.append(one.merge(two))
        assert parts[0] == batch.joint
    figure(f"b. forward model: {ROWS} one-row updates and {splits} random splits equal the batch, bit for bit")


def test_prey_models(figure):
    rng = np.random.default_rng(1)
    rows = [Polar(*row) for row in np.column_stack(
        [rng.gamma(4.0, 0.04, ROWS), rng.vonmises(0.0, 2.0, ROWS), rng.vonmises(0.3, 1.0, ROWS)]).tolist()]  # fmt: skip
    batch = observe(rows)
    for _ in range(20):
        shuffled = [rows[i] for i in rng.permutation(ROWS)]
        cuts = np.sort(rng.integers(0, ROWS, 5)).tolist()
        merged = PreyModel()
        for a, b in zip([0, *cuts], [*cuts, ROWS], strict=True):
            merged = merged.merge(observe(shuffled[a:b]))
        assert merged == batch
        assert merged.counts.equals(batch.counts)
        assert merged.predict(7) == batch.predict(7)
    figure(f"b. prey model: {ROWS} observations in 20 orders and splits equal the batch, bit for bit")


def observe(rows):
    model = PreyModel()
    for row in rows:
        model.observe(row)
    return model
