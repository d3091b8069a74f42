"""Figures of scores: a body that stays does not squeeze the models that are compared."""

from __future__ import annotations

import pandas as pd
import pytest

from bayeshunt.views.figures.scores import forward_scores


@pytest.mark.parametrize(("stays", "cut"), [(0.8, True), (0.12, False)])
def test_a_row_far_behind_is_an_arrow_and_its_number(stays, cut):
    errors = {"stays": stays, "unicycle": 0.1, "table": 0.08}
    table = pd.DataFrame([
        {"model": name, "n": 50, "position_m": e, "position_low": 0.9 * e, "position_high": 1.1 * e,
         "heading_deg": 10 * e, "heading_low": 9 * e, "heading_high": 11 * e}
        for name, e in errors.items()
    ])  # fmt: skip
    figure = forward_scores(table)
    axes = figure.axes[0]
    assert f"{1000 * stays:.3g}" in [text.get_text() for text in axes.texts]
    assert axes.get_xlim()[1] < 200
    assert ("arrow" in axes.get_title(loc="left") + axes.get_title()) is cut
