"""Settings files: presets, a user's own, and one clear line for what is wrong."""

import pytest

import bayeshunt as bh
from bayeshunt.config.loading import describe, load_experiment, load_robot, preset_names
from bayeshunt.config.schema import drives
from bayeshunt.core.errors import ConfigError

BODY = '[[gait]]\nname = "go"\nleft = 0.05\nright = 0.05\n'


def write(tmp_path, text, name="mine.toml"):
    path = tmp_path / name
    path.write_text(text)
    return path


@pytest.mark.parametrize("name", preset_names("robots"))
def test_every_robot_preset_loads(name):
    robot = load_robot(name)
    assert robot.name == name
    assert len(robot.gaits) >= 2
    assert robot.gaits.duration == robot.gait_duration


def test_the_paper_preset_says_that_it_was_fitted():
    paper = load_experiment("paper")
    assert paper.protocol.thetas == (0, 1, 2, 3, 4, 5, 6)
    assert "not in the paper" in paper.note
    assert paper.published["reactive"] == {"walled": 0.1457}


def test_settings_are_frozen():
    with pytest.raises(ValueError, match="frozen"):
        load_experiment("paper").protocol.runs = 3


def test_a_users_file_may_change_only_some_keys(tmp_path):
    write(tmp_path, 'name = "tiny"\n' + BODY, "robot.toml")
    path = write(tmp_path, 'base = "paper"\nrobot = "robot.toml"\n[prey]\nspeed = 0.03\n')
    mine = load_experiment(path)
    assert mine.name == "mine"
    assert mine.robot.name == "tiny"
    assert mine.prey.speed == 0.03
    assert mine.arenas["walled"].width == 1.2


def test_overrides_by_dotted_key():
    assert load_experiment("paper", {"prey.speed": 0.02}).prey.speed == 0.02
    again = load_experiment(load_experiment("paper"), {"protocol.runs": 3})
    assert again.protocol.runs == 3


def test_the_order_of_overrides_means_nothing():
    changes = {"robot": "car", "robot.gait_duration": 1.0}
    one, other = load_experiment("paper", changes), load_experiment("paper", dict(reversed(changes.items())))
    assert one == other
    assert (one.robot.name, one.robot.gait_duration) == ("car", 1.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name = ", "not valid TOML"),
        ('base = "papr"\n', "base: expected a preset"),
        ('base = "paper"\n[prey]\nsped = 1\n', r"prey\.sped: unknown key; did you mean 'speed'\?"),
        ('base = "paper"\n[prey]\nspeed = -1\n', r"prey\.speed: .*greater than or equal to 0, got -1"),
        ('base = "paper"\n[prey]\nspeed = nan\n', r"prey\.speed: .*"),
        ('base = "paper"\n[prey.body]\ndrive = "legs"\n', r"prey\.body\.drive: .*'differential'.*got 'legs'"),
        (
            'base = "paper"\n[robot.body]\ndrive = "legs"\ntop_speed = 0.1\n',
            r"robot\.body\.axle: unknown key for this body, whose drive is 'legs'; .* robot = 'hexapod' or ",
        ),
        ('base = "paper"\n[protocol]\nruns = "many"\n', r"protocol\.runs: .*got 'many'"),
        ('base = "paper"\n[protocol]\nthetas = []\n', r"protocol\.thetas: "),
        ('base = "paper"\nrobot = "kepera"\n', "no preset called 'kepera'; did you mean 'khepera'"),
        ('base = "paper"\nprey = 3\n', r"prey: input should be a valid dictionary.*got 3"),
        ('base = "paper"\narenas = "open"\n', r"arenas: input should be a valid dictionary, got 'open'"),
        ('base = "paper"\nrobot = ["khepera"]\n', "robot: input should be a valid dictionary"),
        ('name = "x"\n', "robot: required, but not given"),
    ],
)
def test_experiment_mistakes(tmp_path, text, message):
    path = write(tmp_path, text)
    with pytest.raises(ConfigError, match=message) as caught:
        load_experiment(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('name = "r"\n', "gait: required"),
        ('name = "r"\n' + BODY + BODY, "gait name 'go' stands twice"),
        ('name = "r"\n[[gait]]\nname = "go"\nleft = 0.05\n', "differential drive needs left and right"),
        ('name = "r"\n[body]\ndrive = "car"\n' + BODY, "car drive needs speed and steering"),
        (
            'name = "r"\n[body]\ndrive = "car"\n[[gait]]\nname = "go"\nspeed = 0.1\nsteering = 1.2\n',
            "steers beyond body.max_steering",
        ),
        ('name = "r"\ngait_duration = 0\n' + BODY, "gait_duration: .*greater than 0"),
    ],
)
def test_robot_mistakes(tmp_path, text, message):
    with pytest.raises(ConfigError, match=message):
        load_robot(write(tmp_path, text))


@pytest.mark.parametrize("key", ["prey", "arenas", "protocol", "robot"])
def test_an_override_that_is_no_group(key):
    with pytest.raises(ConfigError, match=f"{key}: input should be a valid dictionary"):
        load_experiment("paper", {key: 3})


@pytest.mark.parametrize("load", [load_robot, load_experiment])
def test_what_is_no_name_is_refused(load):
    with pytest.raises(ConfigError, match=r"expected the name of a preset or the path of a \.toml file, got 3"):
        load(3)


def test_missing_and_binary_files(tmp_path):
    with pytest.raises(ConfigError, match="cannot be read"):
        load_robot(tmp_path / "nowhere.toml")
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigError, match="UTF-8"):
        load_robot(tmp_path / "b.toml")


@pytest.mark.parametrize("kind", ["experiment", "robot"])
def test_every_key_has_a_meaning(kind):
    rows = describe(kind)
    assert len(rows) > 15
    bare = [row["key"] for row in rows if not row["meaning"]]
    assert not bare


@pytest.mark.parametrize(
    ("change", "published"),
    [
        ({"protocol.runs": 3}, True),
        ({"prey.speed": 0.048}, True),
        ({"planner.planning.depth": 4}, True),
        ({"prey.speed": 0.03}, False),
        ({"robot": "car"}, False),
        ({"protocol.time_limit": 30}, False),
        ({"arenas.walled.width": 2.0}, False),
        ({"model.babbling_steps": 100}, False),
    ],
)
def test_a_changed_experiment_is_not_held_against_the_paper(tmp_path, change, published):
    paper = load_experiment("paper")
    for changed in (load_experiment("paper", change), load_experiment(paper, change)):
        assert bool(changed.published) == published
        assert (changed.note == paper.note) == published
        assert published or "no published counterpart" in changed.note


def test_a_users_file_is_not_held_against_the_paper(tmp_path):
    mine = load_experiment(write(tmp_path, 'base = "paper"\n[prey]\nspeed = 0.03\n'))
    assert not mine.published
    assert "Changed from 'paper' (prey)" in mine.note
    own = load_experiment(
        write(tmp_path, 'base = "paper"\nnote = "ours"\n[prey]\nspeed = 0.03\n[published.planning]\nopen = 0.5\n')
    )
    assert own.published["planning"]["open"] == 0.5
    assert own.note == "ours"
    same = load_experiment(write(tmp_path, 'base = "paper"\n[protocol]\nruns = 3\n'))
    assert same.published == load_experiment("paper").published


def test_an_arena_is_checked_when_it_is_used(tmp_path):
    tight = load_experiment("paper", {"arenas.walled.width": 0.2})
    tight.check_arena("open")
    with pytest.raises(ConfigError, match=r"arenas\.walled\.width and height: the prey would start in a wall"):
        tight.check_arena("walled")


@pytest.mark.parametrize(
    ("second", "said"),
    [
        ("name = 'slow'\nlft = 1", "gait 2 ('slow').lft: unknown key; did you mean 'left'?"),
        ("name = 'slow'\nleft = 'x'", "gait 2 ('slow').left: input should be a valid number"),
        ("left = 1", "gait 2.name: required, but not given"),
    ],
)
def test_one_of_several_gaits_is_said_by_number_and_name(tmp_path, second, said):
    first = "name = 'fast'\nleft = 0.1\nright = 0.1"
    text = f"name = 'mine'\n[[gait]]\n{first}\n[[gait]]\n{second}\n"
    (tmp_path / "mine.toml").write_text(text)
    with pytest.raises(ConfigError) as caught:
        load_robot(tmp_path / "mine.toml")
    assert str(caught.value).startswith(f"{tmp_path / 'mine.toml'}: {said}")


def test_ranges_are_said_in_the_words_of_the_planners():
    ranges = {row["key"]: row["range"] for row in describe("experiment")}
    assert ranges["name"] == "text"
    assert ranges["prey.senses_hunter"] == "true or false"
    assert ranges["model.angle_bins"] == "whole number >= 1, <= 3600"
    assert ranges["robot.gait[].left"] == "number or none"
    assert ranges["robot.noise.slip"] == "number >= 0, < 1"
    assert ranges["robot.body.drive"] == "differential | car"
    assert ranges["planners"] == "list"


def test_a_file_may_begin_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "bom.toml"
    path.write_bytes(b'\xef\xbb\xbfbase = "paper"\n[protocol]\nruns = 1\n')
    assert load_experiment(path).protocol.runs == 1


def test_a_body_of_ones_own_takes_the_gaits_of_wheels(monkeypatch):
    kind = drives.DriveKind(bh.DriveSettings, ("left", "right"), lambda command: abs(sum(command)) / 2)
    monkeypatch.setitem(drives._DRIVES, "metered", kind)
    body = {"drive": "metered", "diameter": 0.057}
    robot = bh.load_experiment("paper", {"robot.body": body}).robot
    assert robot.gaits[1].command == (0.0576, 0.0432)
    assert robot.top_speed == pytest.approx(0.0576)
