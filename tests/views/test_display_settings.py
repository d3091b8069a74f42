"""Robots, repertoires, experiments and planners show themselves in words, not as dumps."""

import pytest

import bayeshunt as bh


@pytest.fixture(scope="module")
def things(khepera_model):
    robot = bh.load_robot("khepera")
    planner = bh.make_planner("proportional_navigation", khepera_model, navigation_constant=4.0)
    return {"robot": robot, "gaits": robot.gaits, "experiment": bh.load_experiment("paper"), "planner": planner}


@pytest.mark.parametrize(
    ("name", "line", "says"),
    [
        ("robot", "<RobotSettings 'khepera': differential drive, 10 gaits>", "wide right          57.6        43.2"),
        ("gaits", "<GaitRepertoire: 10 gaits, body 57 mm, each held 3.328 s>", "wide right     0.0576, 0.0432"),
        (
            "experiment",
            "<ExperimentSettings 'paper': reactive, prediction, planning in walled, open, 7 bearings x 100 runs>",
            "walled  1.2 m x 1.2 m",
        ),
        ("planner", "<planner proportional_navigation: navigation_constant 4.0>", "navigation_constant    4.0"),
    ],
)
def test_in_a_line_as_text_and_in_a_notebook(things, name, line, says):
    thing = things[name]
    assert repr(thing) == line
    text = str(thing)
    assert says in text
    assert max(map(len, text.splitlines())) <= 110
    assert "object at" not in text
    page = thing._repr_html_()
    assert type(page) is str
    assert page.startswith("<style>")
    assert all(word in page for word in says.split())


def test_a_car_is_shown_by_its_steering():
    text = str(bh.load_robot("car"))
    assert "speed mm/s  steering °" in text
    assert "tight right          45.0       -33.2" in text


@pytest.mark.parametrize("name", bh.planner_names(standalone=True))
def test_every_planner_shows_itself(khepera_model, name):
    planner = bh.make_planner(name, khepera_model)
    assert repr(planner).startswith(f"<planner {name}")
    assert str(planner).startswith(f"Planner {name}: ")


def test_names_are_text_and_no_markup():
    robot = bh.load_robot("khepera").model_dump()
    robot["gait"][0]["name"] = "<script>x</script>"
    page = bh.RobotSettings.model_validate(robot)._repr_html_()
    assert "<script>" not in page
