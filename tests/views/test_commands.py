"""Commands that pages print can be typed as they stand."""

import shlex

import numpy as np

from bayeshunt.config.loading import load_experiment
from bayeshunt.views.pages.commands import hunt_command


def test_a_bearing_from_a_table_is_a_plain_number():
    line = hunt_command(load_experiment("paper"), "planning", "open", np.float64(6.0), np.int64(7))
    words = shlex.split(line)
    assert words[words.index("--theta") + 1] == "6.0"
    assert words[words.index("--seed") + 1] == "7"
