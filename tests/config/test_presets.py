"""The presets that ship, and what each says of itself."""

import pytest

import bayeshunt as bh
from bayeshunt.config.loading import preset_names


def test_what_ships():
    assert preset_names() == [
        "clutter",
        "detour",
        "follow",
        "legs",
        "legs_camera",
        "oses2010",
        "paper",
        "portia",
        "slippery",
    ]
    robots = {bh.load_experiment(name).robot.name for name in preset_names()}
    assert robots == {"follower", "khepera", "khepera_oses2010", "hexapod_mixed"}


def test_the_prey_of_legs_is_a_sixth_slower_than_its_hunter_and_as_large():
    settings = bh.load_experiment("legs")
    assert settings.robot.top_speed / settings.prey.speed == pytest.approx(1.2, abs=1e-3)
    assert settings.robot.body.body_length == settings.prey.body.diameter


def test_slippery_is_the_paper_on_another_floor_and_its_answers_are_graded():
    paper, slippery = bh.load_experiment("paper"), bh.load_experiment("slippery")
    for noise in (slippery.robot.noise, slippery.prey.noise):
        assert (noise.slip, noise.drift_sd) == (0.6, 0.2)
    assert slippery.robot.model_dump(exclude={"noise"}) == paper.robot.model_dump(exclude={"noise"})
    assert slippery.prey.model_dump(exclude={"noise"}) == paper.prey.model_dump(exclude={"noise"})
    assert slippery.published == {}
    model = bh.ForwardModel.fit(bh.babble(slippery.robot, 1000, 0), slippery.robot.gaits)
    best = bh.InverseModel(model).table()[list(model.gaits.names)].to_numpy().max(axis=1)
    assert (best < 0.999).mean() > 0.4
    assert (best < 0.8).mean() > 0.2


@pytest.mark.parametrize("name", ["oses2010", "paper"])
def test_each_note_says_fitted_to_what_and_not_unique(name):
    note = bh.load_experiment(name).note
    for word in ("Fitted", "free numbers against", "report", "not unique"):
        assert word.lower() in note.lower()
    assert "\n" not in note


def test_the_robot_of_oses2010():
    robot = bh.load_robot("khepera_oses2010")
    assert robot == bh.load_experiment("oses2010").robot
    assert robot.top_speed / bh.load_experiment("oses2010").prey.speed == pytest.approx(1.224, abs=5e-4)
    mirrored = {(g.right, g.left) for g in robot.gait}
    assert all((g.left, g.right) in mirrored for g in robot.gait)
    for gait in robot.gait:  # a right gait drives its left wheel faster
        assert (gait.left > gait.right) == gait.name.startswith("right")
