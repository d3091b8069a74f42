"""The explorer's Python side: every number it sends is the inverse model's."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import InputError

pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")


@pytest.fixture(scope="module")
def explorer(khepera_model):
    return bh.Explorer(khepera_model)


@pytest.mark.parametrize(("distance", "angle"), [(0.0, 0.0), (0.1, 0.5), (0.19, -0.02), (0.03, 3.1), (5.0, -2.0)])
def test_moving_the_target_asks_the_inverse_model(explorer, khepera_model, distance, angle):
    explorer.distance, explorer.angle = distance, angle
    answer = bh.InverseModel(khepera_model).posterior(distance, angle)
    sent = explorer._answer
    assert sent["probabilities"] == answer.values.tolist()
    assert sent["evidence_probability"] == answer.evidence_probability
    assert (sent["support"], sent["snapped"], sent["best"]) == (answer.support, answer.snapped, answer.best)
    assert sent["cell"] == [answer.cell.distance_bin, answer.cell.angle_bin]
    assert explorer.answer.source.values.tolist() == answer.values.tolist()


def test_predicted_outcomes_are_the_mixture_of_the_gaits_tables(explorer, khepera_model):
    from bayeshunt.views.notebook.explorer_widget import outcome_table

    answer = bh.InverseModel(khepera_model).posterior(0.05, 1.0)
    table = outcome_table(explorer.inverse, answer)
    distance, angle = khepera_model.probabilities("Distance"), khepera_model.probabilities("Angle")
    expected = sum(p * np.outer(distance[:, g], angle[:, g]) for g, p in enumerate(answer.values))
    np.testing.assert_allclose(table, expected, atol=1e-12)
    assert table.sum() == pytest.approx(1.0)
    explorer.distance, explorer.angle = 0.05, 1.0
    for d, a, probability in explorer._answer["outcomes"]:
        assert probability == pytest.approx(table[d, a], rel=1e-3)


def test_the_scene_holds_the_learned_cells_and_the_mean_paths(explorer, khepera_model):
    scene = explorer._scene
    table = bh.InverseModel(khepera_model).table()
    assert [cell[2] for cell in scene["cells"]] == table["support"].tolist()
    width = khepera_model.axes.distance.width
    np.testing.assert_allclose([(cell[0] + 0.5) * width for cell in scene["cells"]], table["distance"])
    for gait, path in zip(khepera_model.gaits.names, scene["paths"], strict=True):
        end = khepera_model.predict(gait)
        np.testing.assert_allclose(path[-1], [end.forward, end.right], atol=5.1e-5)


@pytest.mark.parametrize("change", [{"distance": -0.1}, {"distance": float("nan")}, {"angle": float("inf")}])
def test_a_target_out_of_range_is_refused(khepera_model, explorer, change):
    with pytest.raises(InputError, match="expected distance >= 0"):
        bh.Explorer(khepera_model, **change)
    before = (explorer.distance, explorer.angle)
    for name, value in change.items():
        with pytest.raises(InputError, match="expected distance >= 0"):
            setattr(explorer, name, value)
    assert (explorer.distance, explorer.angle) == before


def test_another_thing_than_a_model_is_refused():
    with pytest.raises(InputError, match="needs a ForwardModel or an InverseModel, got str"):
        bh.Explorer("model.json")


def test_without_anywidget_it_says_what_to_install():
    code = (
        "import sys; sys.modules['anywidget'] = None\n"
        "import bayeshunt as bh\n"
        "try: bh.Explorer(None)\n"
        "except bh.InputError as error: print(error)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "the explorer needs anywidget: pip install '.[notebook]' in bayeshunt's folder"


def test_the_explorer_of_an_import_knows_no_support(khepera_model, tmp_path):
    khepera_model.to_xmlbif(tmp_path / "model.xmlbif")
    imported = bh.import_network(tmp_path / "model.xmlbif")
    explorer = bh.Explorer(imported)
    assert explorer._answer["support"] is None
    assert explorer._answer["rows"].startswith("unknown")
    assert explorer._scene["counted"] is False
    assert {cell[2] for cell in explorer._scene["cells"]} == {None}
    for gait, path in zip(imported.gaits.names, explorer._scene["paths"], strict=True):
        end = imported.predict(gait)
        np.testing.assert_allclose(path, [[0, 0], [end.forward, end.right]], atol=5.1e-5)


def test_who_has_no_kernel_sees_the_answer_and_no_address(khepera_model):

    explorer = bh.Explorer(khepera_model, distance=0.15, angle=0.4)
    data, _ = explorer._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data
    assert data["text/html"] == explorer.answer._repr_html_()
    assert type(data["text/html"]) is str
    assert data["text/plain"] == str(explorer.answer)
    assert not any("object at 0x" in str(part) for part in data.values())


def test_how_sure_each_probability_is_stands_beside_it(explorer, khepera_model):
    explorer.distance, explorer.angle = 0.168, -0.35
    found = bh.InverseModel(khepera_model).posterior(0.168, -0.35).interval()
    sent = explorer._answer
    np.testing.assert_allclose([row[:2] for row in sent["within"]], found[["low", "high"]])
    assert " to " in sent["within"][0][2]
    assert "95 % interval" in sent["sure"]


def test_of_an_imported_network_nobody_knows_how_sure(khepera_model, tmp_path):
    khepera_model.to_xmlbif(tmp_path / "m.xmlbif")
    explorer = bh.Explorer(bh.import_network(tmp_path / "m.xmlbif"))
    assert (explorer._answer["within"], explorer._answer["sure"]) == (None, None)
