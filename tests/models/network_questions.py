"""Small networks of every structure, and random questions to them."""

from model_cases import babbled, repertoire, small_axes

import bayeshunt as bh

STRUCTURES = ("naive", "tan", "joint", "previous_gait", "learned")


def fitted(structure):
    rows = babbled(300, seed=4)
    rows["previous_gait"] = rows["gait"].shift(1)
    return bh.ForwardModel.fit(rows, repertoire(), 0.3, axes=small_axes(3, 4, 5), structure=structure)


def asked(network, count, rng):
    """Random (node, evidence, likelihood)."""
    for _ in range(count):
        names = list(rng.permutation(network.nodes))
        node, known = names[0], names[1 : 1 + rng.integers(0, len(names))]
        evidence = {name: network.states[name][rng.integers(len(network.states[name]))] for name in known}
        rest = [name for name in names if name not in known]
        soft = rest[: rng.integers(0, len(rest) + 1)]
        yield node, evidence, {name: rng.random(len(network.states[name])) for name in soft}
