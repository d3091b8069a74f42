"""What the hunter perceives does not depend on when somebody asks."""

import pytest

import bayeshunt as bh
from bayeshunt.core.messages import Observation
from bayeshunt.episodes.pursuit import Pursuit

CAMERA = {"sensing.preset": "camera_narrow", "sensing.tracker_settings": {"particles": 100}}
GAITS = ("straight", "straight", "straight", "wide left")


@pytest.mark.parametrize("sensing", [{}, CAMERA], ids=["exact", "camera"])
def test_a_situation_is_the_same_whether_or_not_those_before_were_asked_for(sensing):
    settings = bh.load_experiment("paper", sensing)
    looking, late = (Pursuit(settings, "open", 0.0, 5) for _ in range(2))
    for gait in GAITS:
        assert looking.situation.step == looking.decisions
        looking.step(gait)
        late.step(gait)
    assert late.observed == looking.observed is not None  # of the last situation that was passed
    assert late.prey_model == looking.prey_model
    assert late.prey_model.observations == looking.prey_model.observations > 0
    one, other = looking.situation, late.situation
    assert (one.prey, one.pose, one.time, one.step) == (other.prey, other.pose, other.time, other.step)
    assert (one.previous_gait, one.transitions) == (other.previous_gait, other.transitions)
    assert one.belief.mean == other.belief.mean
    assert one.transitions
    assert tuple(one.approaches) == tuple(other.approaches)
    assert looking.result == late.result
    assert (late.result.decisions, late.result.transitions) == (4, 1)


def test_a_sensor_that_needs_all_of_a_run_is_given_it_late_too():
    """Of every interval since the last look, not of the last moment alone."""

    class Counting:
        def __init__(self, context):
            self.context, self.moments = context, []

        def sense(self, run, map, *, rng):
            self.moments.append(len(run.moments))
            pose = run.moments[-1].poses[self.context.hunter]
            return Observation(run.moments[-1].time, pose)

    made = []
    bh.register_sensor("counting", lambda context: made.append(Counting(context)) or made[-1])
    pursuit = Pursuit(bh.load_experiment("paper", {"sensing.sensor": "counting"}), "open", 0.0, 1)
    for _ in range(2):
        pursuit.step(0)
    assert made[0].moments == []
    assert pursuit.situation.step == 2
    assert made[0].moments == [1, 52, 52]
