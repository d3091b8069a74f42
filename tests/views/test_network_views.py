"""A whole network shown: as text, as a widget, as a page."""

import numpy as np
import pytest
from typer.testing import CliRunner

import bayeshunt as bh
from bayeshunt.cli import app
from bayeshunt.views.pages.network import network_data


@pytest.fixture(scope="module")
def network():
    robot = bh.load_robot("khepera")
    return bh.Network(bh.ForwardModel.fit(bh.babble(robot, steps=300, seed=0), robot.gaits))


def test_the_data_of_a_page_hold_every_number(network):
    data = network_data(network)
    for node, table in zip(data["nodes"], network.tables.values(), strict=True):
        runs = node["runs"]
        values = [v for value, count in zip(runs[::2], runs[1::2], strict=True) for v in [value] * count]
        assert values == (table.T if table.ndim == 2 else table).ravel().tolist()
        assert len(node["labels"]) == len(node["states"]) == len(table)
    assert data["asked"] == "Gait"


def test_the_data_of_a_page_hold_what_was_counted(network, tmp_path):
    """The Dirichlet parameters of each table; P(Gait) was set, and of an imported network nobody counted anything."""
    data = network_data(network)
    assert ["weights" in node for node in data["nodes"]] == [False, True, True, True]
    for node, weights in network.weights.items():
        rows = weights - 1.0 / len(weights)  # no prior: 1/K a cell
        np.testing.assert_allclose(rows, np.round(rows), atol=1e-9)
        assert rows.sum() == pytest.approx(300), node
    assert "1/K" in data["pseudo"]
    robot = bh.load_robot("khepera")
    bh.ForwardModel.fit(bh.babble(robot, steps=300, seed=0), robot.gaits).to_xmlbif(tmp_path / "m.xmlbif")
    imported = network_data(bh.Network(bh.import_network(tmp_path / "m.xmlbif")))
    assert imported["pseudo"] == ""
    assert not any("weights" in node for node in imported["nodes"])


def test_a_network_shows_itself(network):
    pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")
    data, _ = network._repr_mimebundle_()
    assert {"text/plain", "text/html", "application/vnd.jupyter.widget-view+json"} <= set(data)
    assert "Gait      " in str(network)
    network.widget.evidence = {"Distance": 0.05}
    assert network.widget.evidence == {"Distance": network.states["Distance"][network._state("Distance", 0.05)]}
    with pytest.raises(bh.InputError, match="unknown node"):
        network.widget.evidence = {"Distanz": 0.05}


def test_a_page_is_refused_where_it_cannot_be(network, tmp_path):
    with pytest.raises(bh.InputError, match=r"name it .*net\.html"):
        network.save(tmp_path / "net.png")


def test_a_network_over_any_nodes_is_read_from_its_file(tmp_path):
    text = (
        "network rain {\n}\nvariable rain {\n type discrete [ 2 ] { no, yes };\n}\n"
        "variable wet {\n type discrete [ 2 ] { no, yes };\n}\n"
        "probability ( rain ) {\n table 0.8, 0.2;\n}\n"
        "probability ( wet | rain ) {\n (no) 0.9, 0.1;\n (yes) 0.2, 0.8;\n}\n"
    )
    (tmp_path / "rain.bif").write_text(text)
    network = bh.Network(tmp_path / "rain.bif")
    assert network.posterior("rain", {"wet": "yes"})["yes"] == pytest.approx(0.16 / 0.24)
    network.save(tmp_path / "rain.html")
    assert "2 nodes, 1 edges" in (tmp_path / "rain.html").read_text()


def test_export_writes_the_page(network, tmp_path):
    robot = bh.load_robot("khepera")
    bh.ForwardModel.fit(bh.babble(robot, steps=300, seed=0), robot.gaits).save(tmp_path / "m.json")
    words = ["export", str(tmp_path / "m.json"), "--out", str(tmp_path / "t"), "--page", str(tmp_path / "net.html")]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    assert "Content-Security-Policy" in (tmp_path / "net.html").read_text()
