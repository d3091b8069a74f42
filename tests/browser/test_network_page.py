"""The page of a network: what it works out, against other programs; what a hand and a keyboard do."""

from __future__ import annotations

import json
import math
import re
import warnings

import numpy as np
import pytest
from network_questions import STRUCTURES, asked, fitted

import bayeshunt as bh
from bayeshunt.views.pages.network import SCRIPTS, network_data
from bayeshunt.views.pages.page import asset

ENGINE = """<!doctype html><meta charset=utf-8><title>engine</title>
<script type="application/json" id="d">{data}</script><script>{script}
const data = JSON.parse(document.getElementById("d").textContent), net = makeNetwork(data.nodes);
const at = Object.fromEntries(data.nodes.map((node, i) => [node.name, i]));
function read(evidence, likelihood) {{
  const known = data.nodes.map((node) => (node.name in evidence ? node.states.indexOf(evidence[node.name]) : -1));
  return [known, data.nodes.map((node) => (node.name in likelihood ? Float64Array.from(likelihood[node.name]) : null))];
}}
function ask([evidence, likelihood, target]) {{
  const [known, soft] = read(evidence, likelihood), all = answerAll(net, known, soft);
  if (!all) return null;
  const small = data.nodes.length <= 10;
  const best = small ? mostProbable(net, known, soft, all.total) : null;
  return {{
    total: all.total, marginals: all.marginals.map((v) => [...v]), bits: all.bits,
    worth: small ? worthAsking(net, known, soft, at[target], all.marginals) : null,
    best: best && best.states.map((s, i) => data.nodes[i].states[s]), probability: best && best.probability,
  }};
}}
function sure([evidence, target]) {{
  const [known, soft] = read(evidence, {{}}), point = answerAll(net, known, soft).marginals[at[target]];
  const drawing = intervals(net, known, soft, at[target], point);
  let step;
  do step = drawing.next(); while (!step.done);
  return step.value;
}}</script>"""


@pytest.fixture
def engine(open_page, tmp_path):
    """Return a function that opens a network's engine and gives a function that asks it."""

    def opened(network):
        data = json.dumps(network_data(network)).replace("<", "\\u003c")
        script = "".join(asset(name) for name in SCRIPTS[1:-1])  # all but the picture
        (tmp_path / "engine.html").write_text(ENGINE.format(data=data, script=script))
        page, watch = open_page(tmp_path / "engine.html")
        assert watch.errors == []
        return lambda *question, asks="ask": page.evaluate(asks, list(question))

    return opened


def as_python(network, found, evidence, likelihood, target):
    """Hold what the page works out to what Python does."""
    assert found["total"] == pytest.approx(network.probability(evidence, likelihood), rel=1e-9)
    for node, values in zip(network.nodes, found["marginals"], strict=True):
        np.testing.assert_allclose(values, network.posterior(node, evidence, likelihood), atol=1e-9)
    np.testing.assert_allclose(found["bits"], network.mutual_information(evidence, likelihood)["bits"], atol=1e-9)
    if found["worth"] is not None:
        worth = network.value_of_information(target, evidence, likelihood)
        for node, bits in zip(network.nodes, found["worth"], strict=True):
            assert bits == pytest.approx(worth.get(node, 0.0), abs=1e-9)
        states, probability = network.most_probable(evidence, likelihood)
        assert dict(zip(network.nodes, found["best"], strict=True)) == states
        assert found["probability"] == pytest.approx(probability, rel=1e-9)


@pytest.mark.parametrize("structure", ["tan", "previous_gait"])
def test_the_page_works_out_what_python_does(engine, structure):
    network = bh.Network(fitted(structure))
    ask = engine(network)
    for node, evidence, likelihood in asked(network, 15, np.random.default_rng(5)):
        as_python(
            network, ask(evidence, {k: v.tolist() for k, v in likelihood.items()}, node), evidence, likelihood, node
        )


def test_evidence_that_cannot_be(engine):
    rows = bh.babble(bh.load_robot("khepera"), steps=300, seed=0)
    network = bh.Network(bh.ForwardModel.fit(rows, bh.load_robot("khepera").gaits))
    never = network.posterior("Distance", {"Gait": "spin left"}).idxmin()
    assert engine(network)({"Gait": "spin left", "Distance": never}, {}, "Angle") is None


@pytest.mark.slow
@pytest.mark.parametrize("structure", STRUCTURES)
def test_how_sure_the_page_is_as_python_says(engine, structure):
    """Both draw the tables, differently: at most as far apart as draws are."""
    model = fitted(structure)
    ask = engine(bh.Network(model))
    for distance, angle, heading in ((0.05, 0.3, None), (0.1, -1.0, None), (0.15, 2.0, 0.5)):
        answer = bh.InverseModel(model).posterior(distance, angle, heading)
        found = ask(answer.evidence, "Gait", asks="sure")
        np.testing.assert_allclose(found, answer.interval()[["low", "high"]], atol=0.03)


@pytest.mark.slow
def test_how_sure_any_node_is_as_by_plain_draws(engine):
    """Heading where the gait was leant to by a distance: every column of three tables is drawn."""
    model = fitted("naive")
    network, rng, n = bh.Network(model), np.random.default_rng(8), 20_000
    drawn = {}
    for node, weights in network.weights.items():
        gammas = rng.standard_gamma(np.broadcast_to(weights, (n, *weights.shape)))
        drawn[node] = gammas / gammas.sum(axis=1, keepdims=True)
    shares = drawn["Distance"][:, 1] * network.tables["Gait"]
    heading = np.einsum("nhg,ng->nh", drawn["Heading"], shares / shares.sum(axis=1, keepdims=True))
    found = engine(network)({"Distance": network.states["Distance"][1]}, "Heading", asks="sure")
    np.testing.assert_allclose(found, np.quantile(heading, [0.025, 0.975], axis=0).T, atol=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("structure", STRUCTURES)
def test_as_pgmpy_answers_to_nine_digits(engine, structure):
    from pgmpy.factors.discrete import TabularCPD
    from pgmpy.inference import VariableElimination

    model = fitted(structure)
    network, theirs = bh.Network(model), VariableElimination(model.network)
    ask = engine(network)
    for node, evidence, likelihood in asked(network, 200, np.random.default_rng(6)):
        soft = {name: values for name, values in likelihood.items() if name != node}
        virtual = [
            TabularCPD(name, len(values), values[:, None], state_names={name: list(network.states[name])})
            for name, values in soft.items()
        ]
        found = theirs.query([node], evidence=evidence, virtual_evidence=virtual or None, show_progress=False)
        expected = [found.get_value(**{node: state}) for state in network.states[node]]
        answer = ask(evidence, {k: v.tolist() for k, v in soft.items()}, node)
        np.testing.assert_allclose(answer["marginals"][network.nodes.index(node)], expected, atol=1e-9)


def alarm():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from pgmpy.utils import get_example_model

        return get_example_model("alarm")


@pytest.mark.slow
def test_a_network_of_37_nodes_as_pyagrum_answers(engine):
    gum = pytest.importorskip("pyagrum")
    network, rng = bh.Network(alarm()), np.random.default_rng(7)
    theirs = gum.BayesNet()
    for node in network.nodes:
        theirs.add(gum.LabelizedVariable(node, node, list(network.states[node])))
    for parent, child in network.edges:
        theirs.addArc(parent, child)
    for node, table in network.tables.items():
        cpt = theirs.cpt(node)
        order = [*reversed(cpt.names)]  # pyagrum's array has its own variable last
        axes = [(node, *network.parents[node]).index(name) for name in order]
        cpt[:] = np.ascontiguousarray(np.transpose(table, axes))
    ask = engine(network)
    for node, evidence, likelihood in asked(network, 40, rng):
        evidence = dict(list(evidence.items())[:6])
        soft = {name: values.tolist() for name, values in list(likelihood.items())[:4]}
        answer = ask(evidence, soft, node)
        inference = gum.LazyPropagation(theirs)
        inference.setEvidence({**evidence, **soft})
        inference.makeInference()
        if answer is None:
            assert network.probability(evidence, soft) == 0
            continue
        for name, values in zip(network.nodes, answer["marginals"], strict=True):
            np.testing.assert_allclose(values, inference.posterior(name).toarray(), atol=1e-9)


# --- the picture -------------------------------------------------------------------------------


@pytest.fixture
def saved(model, tmp_path):
    bh.Network(model).save(tmp_path / "network.html")
    return tmp_path / "network.html"


def test_a_click_is_evidence_and_a_second_gesture_a_likelihood(open_page, saved, model):
    page, watch = open_page(saved)
    network = bh.Network(model)
    state = int(network.posterior("Distance").argmax())
    evidence = {"Distance": network.states["Distance"][state]}
    page.get_by_role("listbox", name="Distance").get_by_role("option").nth(state).click()
    expected = network.posterior("Gait", evidence)
    rows = page.get_by_role("listbox", name="Gait").get_by_role("option")
    shown = [float(text.split()[-1].replace("<", "").replace(">", "")) for text in rows.all_inner_texts()]
    assert shown == pytest.approx(expected.tolist(), abs=1.5e-3)
    assert page.get_by_text(f"P(evidence) = {network.probability(evidence):.4g}").is_visible()
    best, _ = network.most_probable(evidence)
    assert page.get_by_text(best["Gait"], exact=True).last.is_visible()
    page.get_by_role("button", name="Clear all").click()
    rows.first.click(modifiers=["Shift"])
    gait = network.posterior("Gait", likelihood={"Gait": [3.0] + [1.0] * 9})
    assert float(rows.first.inner_text().split()[-1]) == pytest.approx(gait.iloc[0], abs=1e-3)
    assert [url for url in watch.requests if not url.startswith(("file:", "data:"))] == []
    assert watch.errors == []


def test_the_keyboard_alone(open_page, saved):
    page, watch = open_page(saved)
    gaits = page.get_by_role("listbox", name="Gait")
    gaits.focus()
    page.keyboard.press("Home")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    assert gaits.locator("[aria-selected=true]").inner_text().split()[-1] == "1.000"
    assert page.get_by_role("status").inner_text().startswith("Gait is wide right.")
    page.keyboard.press("l")  # likely rather than known
    assert gaits.locator("[aria-selected=true]").count() == 0
    assert page.get_by_role("button", name="Take back Gait ≈ wide right").is_visible()
    page.keyboard.press("Escape")
    assert page.get_by_text("nothing is known yet").is_visible()
    page.get_by_role("listbox", name="Heading").focus()
    page.keyboard.press("a")
    assert page.get_by_role("button", name="Heading", exact=True).get_attribute("aria-pressed") == "true"
    assert watch.errors == []


def test_an_answer_of_one_row_is_not_sure(open_page, tmp_path, khepera_model):
    """At 168 mm, -20 degrees of the shipped table: whiskers on every bar that has a width, numbers beside."""
    network = bh.Network(khepera_model)
    answer = bh.InverseModel(khepera_model).posterior(0.168, math.radians(-20))
    network.save(tmp_path / "network.html")
    page, watch = open_page(tmp_path / "network.html")
    for node, state in answer.evidence.items():
        page.get_by_role("listbox", name=node).get_by_role("option").nth(network.states[node].index(state)).click()
    said = page.get_by_text(re.compile(rf"Most probable: {answer.best} 1\.000 \("))
    said.wait_for()
    low, high = map(float, re.search(r"\(([\d.]+) to ([\d.]+)\)", said.inner_text()).groups())
    assert low == pytest.approx(answer.interval()["low"][answer.best], abs=0.03)
    assert low < 0.5
    assert high == 1
    bar = page.get_by_role("listbox", name="Gait").get_by_role("option").nth(answer.values.argmax())
    whisker, track = (bar.locator(f".{part}").bounding_box() for part in ("whisker", "track"))
    assert whisker["x"] - track["x"] == pytest.approx(low * track["width"], abs=2)
    page.get_by_role("button", name="Clear all").click()
    assert page.locator(".state .whisker").count() == 0  # a uniform P(Gait) was set, not estimated
    assert watch.errors == []


def test_the_gait_known_separates_the_effects(open_page, saved):
    page, _ = open_page(saved)
    page.get_by_role("button", name="Angle", exact=True).click()
    apart = page.locator("section.node.apart")
    assert apart.count() == 0
    page.get_by_role("listbox", name="Gait").get_by_role("option").first.click()
    assert {node.get_attribute("aria-label") for node in apart.all()} == {"Distance", "Heading"}


def test_it_fits_a_phone(open_page, saved):
    page, _ = open_page(saved, viewport={"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.get_by_text("from Gait").first.wait_for(state="visible")
