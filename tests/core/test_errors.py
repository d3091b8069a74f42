"""How an error about an unknown name ends."""

import pytest

import bayeshunt as bh
from bayeshunt.core.errors import did_you_mean


def test_the_nearest_name_is_offered_or_else_all_of_them():
    assert did_you_mean("planing", ["reactive", "planning"]) == "; did you mean 'planning'?"
    assert did_you_mean("zzz", ["reactive", "planning"]) == "; expected one of reactive, planning"
    assert did_you_mean("zzz", ["reactive", "planning"], listed=False) == ""
    assert did_you_mean("zzz", []) == ""
    assert did_you_mean(["planning"], {"planning": 1}) == "; expected one of planning"


@pytest.mark.parametrize(
    ("call", "meant"),
    [
        (lambda: bh.describe_planner("interccept"), "intercept"),
        (lambda: bh.load_experiment("papr"), "paper"),
        (lambda: bh.load_robot("kar"), "car"),
        (lambda: bh.load_experiment("paper").check_arena("waled"), "walled"),
        (lambda: bh.learn_room("paper", arena="opn"), "open"),
        (lambda: bh.Structure("naiv", ()), "naive"),
        (lambda: bh.evaluate("paper", planners="planing"), "planning"),
        (lambda: bh.evaluate(bh.load_experiment("paper", {"prey.behaviour": "strait"})), "straight"),
        (lambda: bh.tradeoff("paper", {"distanc": [0.0]}), "distance"),
        (lambda: bh.load_experiment("paper", {"protocol.run": 3}), "runs"),
    ],
)
def test_a_misspelt_name_is_corrected_everywhere(call, meant):
    with pytest.raises(bh.InputError, match=f"did you mean '{meant}'"):
        call()
