"""Arguments of the wrong kind are refused in one line that names them, by every public function alike."""

import re

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.checks import check_generator, check_kind, check_number, check_numbers, check_radians, check_whole
from bayeshunt.core.errors import shown
from bayeshunt.data import babbling_table
from bayeshunt.files import atomic
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.target.memory import PreyMemory
from bayeshunt.planners.bounds.reference import ReferenceTable


def refused(call, says):
    """The call raises InputError with this one line."""
    with pytest.raises(bh.InputError, match=says) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_whole_numbers():
    for value in (2, 10**30, np.int64(2), np.uint8(7)):
        check_whole(value, "n", 2)
    for value in (1, 2.0, np.float64(2.0), "2", None, True, [2], float("nan")):
        refused(lambda value=value: check_whole(value, "n", 2), "^n: expected a whole number of at least 2, got ")


def test_numbers():
    assert [check_number(v, "x") for v in (1, -0.5, np.float32(0.5), np.int64(3))] == [1.0, -0.5, 0.5, 3.0]
    for value in ("1", None, True, [1.0], 1j, float("nan"), float("-inf")):
        refused(lambda value=value: check_number(value, "x", "an angle"), "^x: expected an angle, got ")


def test_radians_are_at_most_a_turn():
    for angle in (0, 1, 6.0, -2 * np.pi, 2 * np.pi, 6.2832):
        assert check_radians(angle, "x") == angle
    for degrees, fix in ((57, "0.9948"), (-6.3, "-0.11"), (360.0, "6.283")):
        refused(lambda value=degrees: check_radians(value, "x"), f"^x: expected radians .* got .*, give {fix} ")
    refused(lambda: check_radians(float("nan"), "x"), "^x: expected a finite number of radians, got nan$")


def test_arrays_of_numbers():
    np.testing.assert_array_equal(check_numbers([[1, 2.5]], "x"), [[1.0, 2.5]])
    for values in ("x", [1, [2, 3]], {"a": 1}):
        refused(lambda values=values: check_numbers(values, "x"), "^x: expected numbers, got ")


def test_generators_and_kinds():
    check_generator(np.random.default_rng(0))
    refused(lambda: check_generator(np.random.RandomState(0)), "^rng must be a numpy.random.Generator, got a value of")
    check_kind(3, "n", int, "a count")
    refused(lambda: check_kind(np.zeros((90, 9)), "n", int, "a count"), "^n: expected a count, got a value of type nd")


def test_values_are_shown_in_one_line():
    assert [shown(v) for v in ("a\nb", 2.5, None)] == ["'a\\nb'", "2.5", "None"]
    assert shown(np.zeros((9, 99))) == "a value of type ndarray"


@pytest.mark.parametrize("path", [3, None, ["model.json"], b"model.json"], ids=repr)
@pytest.mark.parametrize(
    "load",
    [
        bh.ForwardModel.load, bh.import_network, bh.Episode.load, babbling_table.load, RoomModel.load, PreyMemory.load,
        ReferenceTable.load, atomic.write_text,
    ],
    ids=lambda load: load.__qualname__,
)  # fmt: skip
def test_what_is_no_path_is_refused(load, path):
    """A number would be taken for an open file."""
    arguments = (path, "x") if load is atomic.write_text else (path,)
    refused(lambda: load(*arguments), f"^expected the name of .*; got {re.escape(shown(path))}$")


def test_exports_ask_for_a_name(khepera_model):
    refused(lambda: khepera_model.save(3), "^expected the name of a file to write; got 3$")
    refused(lambda: khepera_model.to_csv(3), "^expected the name of a folder; got 3$")
    refused(lambda: khepera_model.to_xmlbif(None), "^expected the name of a file.*; got None$")


def test_a_planner_needs_a_model(khepera_model):
    for given, got in ((None, "None"), (bh.InverseModel(khepera_model), "a value of type InverseModel")):
        for name in ("planning", "kinematic_limit", "intercept"):
            says = f"^planner '{name}': expected a ForwardModel to plan with, got {got}$"
            refused(lambda given=given, name=name: bh.make_planner(name, given), says)
    refused(lambda: bh.InverseModel(None), "^model: expected a ForwardModel, got None$")
    refused(lambda: bh.evaluate("paper", runs=1, model=3), "^model: expected a ForwardModel, got 3$")


def test_a_hunt_needs_numbers_names_and_a_prey_model(khepera_model):
    planner = bh.make_planner("reactive", khepera_model)
    for key, value, says in (
        ("prey_model", 3, "^prey_model: expected a PreyModel or None, got 3$"),
        ("prey_model", khepera_model, "^prey_model: expected a PreyModel or None, got a value of type ForwardModel$"),
        ("theta", "1", "^theta: expected a finite number of radians, got '1'$"),
        ("theta", float("nan"), "^theta: expected a finite number of radians, got nan$"),
        ("seed", 1.0, "^seed: expected a whole number of at least 0, got 1.0$"),
        ("arena", ["open"], "^unknown arena .*; expected one of walled, open$"),
    ):
        refused(lambda key=key, value=value: bh.hunt("paper", planner, **{key: value}), says)


def test_questions_need_numbers(khepera_model):
    inverse = bh.InverseModel(khepera_model)
    for target, says in (
        (("x", 1), "^target: expected two numbers, got 'x' and 1$"),
        ((None, 1), "^target: expected two numbers, got None and 1$"),
        ((0.1, np.zeros(3)), "^target: expected two numbers, got 0.1 and a value of type ndarray$"),
        ((0.1, 1, "x"), r"^target heading: expected a finite angle \[rad\], got 'x'$"),
        ((0.1, 1, float("inf")), r"^target heading: expected a finite angle \[rad\], got inf$"),
    ):
        refused(lambda target=target: inverse.posterior(*target), says)
    refused(lambda: inverse.posterior_many("x", 1), "^distances: expected numbers, got 'x'$")
    refused(lambda: inverse.posterior_many(0.1, [0, [1]]), "^angles: expected numbers, got a value of type list$")
    refused(
        lambda: inverse.posterior_many([0.1, 0.2], [1, 2, 3]), "^targets: 2 distances and 3 angles; expected as many"
    )


def test_samples_and_intervals_need_numbers(khepera_model):
    rng = np.random.default_rng(0)
    for n in (2.5, "x", True, -1):
        refused(
            lambda n=n: khepera_model.sample("straight", n, rng=rng), "^n: expected a whole number of at least 0, got"
        )
    refused(lambda: khepera_model.sample("straight", 2, rng=0), "^rng must be a numpy.random.Generator, got 0$")
    refused(lambda: khepera_model.outcomes("x"), "^uniforms: expected numbers, got 'x'$")
    for level in ("x", None, True, float("nan"), 0.0, 1.0, 95):
        says = f"^level: expected a probability between 0 and 1, got {re.escape(shown(level))}$"
        refused(lambda level=level: khepera_model.credible_interval("Distance", level), says)


def test_a_prey_model_needs_numbers():
    prey = bh.PreyModel()
    for transition in (3, (0.1, 0.2), (0.1, 0.2, "x"), None):
        refused(lambda t=transition: prey.observe(t), "^prey transition: expected a Polar of three numbers, got ")
    prey.observe(bh.Polar(0.1, 0.0, 0.0))
    refused(lambda: prey.predict("x"), "^steps: expected a whole number of at least 0, got 'x'$")
    refused(lambda: prey.sample_paths(2, 3, rng=0), "^rng must be a numpy.random.Generator, got 0$")


def test_provenance_is_the_models_own(khepera_model):
    """What the caller does with his record afterwards changes no model."""
    record = {"sources": [{"seed": 1}]}
    model = bh.ForwardModel.from_counts(khepera_model.joint, provenance=record)
    record["sources"][0]["seed"], record["x"] = 2, 1
    assert model.provenance == {"sources": [{"seed": 1}]}
