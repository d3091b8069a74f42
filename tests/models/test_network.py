"""The whole network asked: against pgmpy and against the full joint table."""

import itertools

import numpy as np
import pandas as pd
import pytest
from network_questions import STRUCTURES, asked, fitted

import bayeshunt as bh
from bayeshunt.core.errors import ImpossibleEvidenceError, InputError


def full(network):
    """P of every combination of states, one axis a node."""
    letters = {name: chr(97 + i) for i, name in enumerate(network.nodes)}
    spelt = ["".join(letters[v] for v in f.variables) for f in network._factors.values()]
    tables = [f.values for f in network._factors.values()]
    return np.einsum(",".join(spelt) + "->" + "".join(letters.values()), *tables)


@pytest.mark.parametrize("structure", STRUCTURES)
def test_as_by_the_full_joint_table(structure):
    network, rng = bh.Network(fitted(structure)), np.random.default_rng(2)
    table = full(network)
    for node, evidence, likelihood in asked(network, 60, rng):
        share = table.copy()
        for name, state in evidence.items():
            keep = np.zeros(len(network.states[name]))
            keep[network.states[name].index(state)] = 1.0
            share = share * np.moveaxis(keep.reshape(-1, *[1] * (share.ndim - 1)), 0, network.nodes.index(name))
        for name, values in likelihood.items():
            share = share * np.moveaxis(values.reshape(-1, *[1] * (share.ndim - 1)), 0, network.nodes.index(name))
        others = tuple(i for i, name in enumerate(network.nodes) if name != node)
        found = network.posterior(node, evidence, likelihood)
        assert list(found.index) == list(network.states[node])
        np.testing.assert_allclose(found, share.sum(axis=others) / share.sum(), atol=1e-12)
        assert network.probability(evidence, likelihood) == pytest.approx(share.sum(), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("structure", STRUCTURES)
def test_as_pgmpy_answers(structure):
    from pgmpy.factors.discrete import TabularCPD
    from pgmpy.inference import VariableElimination

    model = fitted(structure)
    network, engine = bh.Network(model), VariableElimination(model.network)
    for node, evidence, likelihood in asked(network, 200, np.random.default_rng(3)):
        soft = [
            TabularCPD(name, len(values), values[:, None], state_names={name: list(network.states[name])})
            for name, values in likelihood.items()
            if name != node
        ]
        likelihood = {name: values for name, values in likelihood.items() if name != node}
        theirs = engine.query([node], evidence=evidence, virtual_evidence=soft or None, show_progress=False)
        names = theirs.state_names[node]
        expected = pd.Series(theirs.values, index=names).reindex(network.states[node])
        np.testing.assert_allclose(network.posterior(node, evidence, likelihood), expected, atol=1e-9)


def test_a_number_in_si_units_and_the_inverse_model():
    model = fitted("naive")
    network, answer = bh.Network(model), bh.InverseModel(model).posterior(0.15, 0.4, 0.2)
    found = network.posterior("Gait", {"Distance": 0.15, "Angle": 0.4, "Heading": 0.2})
    np.testing.assert_allclose(found, answer.values, atol=1e-12)
    pd.testing.assert_series_equal(found, network.posterior("Gait", answer.evidence))
    np.testing.assert_allclose(
        network.posterior("Distance", {"Gait": model.gaits[0]}), model.cpt("Distance").iloc[:, 0]
    )
    np.testing.assert_array_equal(network.posterior("Gait", {"Gait": "slow"}), [0, 0, 0, 0, 1])


@pytest.mark.parametrize("structure", ["tan", "previous_gait"])
def test_explanation_and_value_of_information_by_brute_force(structure):
    network = bh.Network(fitted(structure))
    table, evidence = full(network), {"Distance": 0.15}
    axis, state = network.nodes.index("Distance"), network._state("Distance", 0.15)
    given = np.take(table, [state], axis=axis)
    given = given / given.sum()
    states, probability = network.most_probable(evidence)
    best = np.unravel_index(given.argmax(), given.shape)
    assert probability == pytest.approx(given.max())
    assert all(
        states[n] == (network.states[n][i] if n != "Distance" else network.states[n][state])
        for n, i in zip(network.nodes, best, strict=True)
    )

    def entropy(p):
        return -sum(v * np.log2(v) for v in np.ravel(p) if v > 0)

    worth = network.value_of_information("Gait", evidence)
    assert set(worth.index) == set(network.nodes) - {"Gait", "Distance"}
    assert list(worth) == sorted(worth, reverse=True)
    for name, bits in worth.items():
        expected = entropy(network.posterior("Gait", evidence))
        for value in network.states[name]:
            share = network.posterior(name, evidence)[value]
            expected -= share * entropy(network.posterior("Gait", {**evidence, name: value}))
        assert bits == pytest.approx(expected, abs=1e-9)


def test_blanket_separation_and_edges():
    network = bh.Network(fitted("naive"))
    assert network.markov_blanket("Distance") == ("Gait",)
    assert network.separated("Distance", "Angle", ["Gait"])
    assert not network.separated("Distance", "Angle")
    assert (network.mutual_information()["bits"] > 0).all()
    assert (network.mutual_information({"Gait": "slow"})["bits"] == 0).all()
    after = bh.Network(fitted("previous_gait"))
    assert after.separated("Gait", "PreviousGait")
    assert not after.separated("Gait", "PreviousGait", ["Distance"])  # a common effect that is seen
    assert set(after.markov_blanket("Gait")) == {"PreviousGait", "Distance", "Angle", "Heading"}


def test_a_network_of_another_kind():
    from pgmpy.factors.discrete import TabularCPD
    from pgmpy.models import DiscreteBayesianNetwork

    made = DiscreteBayesianNetwork([("rain", "wet"), ("sprinkler", "wet")])
    made.add_cpds(
        TabularCPD("rain", 2, [[0.8], [0.2]], state_names={"rain": ["no", "yes"]}),
        TabularCPD("sprinkler", 2, [[0.6], [0.4]], state_names={"sprinkler": ["off", "on"]}),
        TabularCPD(
            "wet", 2, [[1.0, 0.1, 0.2, 0.05], [0.0, 0.9, 0.8, 0.95]], ["rain", "sprinkler"], [2, 2],
            state_names={"wet": ["no", "yes"], "rain": ["no", "yes"], "sprinkler": ["off", "on"]},
        ),
    )  # fmt: skip
    network = bh.Network(made)
    shares = {r: [0.8, 0.2][r] * sum([0.6, 0.4][s] * [[0.0, 0.9], [0.8, 0.95]][r][s] for s in (0, 1)) for r in (0, 1)}
    assert network.posterior("rain", {"wet": "yes"})["yes"] == pytest.approx(shares[1] / sum(shares.values()))
    with pytest.raises(ImpossibleEvidenceError):
        network.posterior("rain", {"wet": "yes", "rain": "no", "sprinkler": "off"})


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda n: n.posterior("Gate"), "Gait"),
        (lambda n: n.posterior("Gait", {"Angle": "north"}), "no state"),
        (lambda n: n.posterior("Gait", {"Distance": 9.0}), "outside"),
        (lambda n: n.posterior("Distance", {"Gait": 1}), "name of one of its states"),
        (lambda n: n.posterior("Gait", likelihood={"Angle": [1.0]}), "4 numbers"),
        (lambda n: n.posterior("Gait", likelihood={"Angle": [1, -1, 1, 1]}), "4 numbers"),
        (lambda n: bh.Network("alarm"), "model"),
    ],
)
def test_what_cannot_be_asked(ask, words):
    with pytest.raises(InputError, match=words):
        ask(bh.Network(fitted("naive")))


def test_every_pair_of_nodes_is_separated_only_if_independent():
    network, table = bh.Network(fitted("tan")), full(bh.Network(fitted("tan")))
    for one, other in itertools.combinations(network.nodes, 2):
        axes = tuple(i for i, name in enumerate(network.nodes) if name not in (one, other))
        pair = table.sum(axis=axes)
        apart = np.allclose(pair, np.outer(pair.sum(axis=1), pair.sum(axis=0)), atol=1e-12)
        assert apart or not network.separated(one, other)
