"""Options of fit: bins and P(Gait) as in Python, and what few steps of babbling lead to."""

import pytest

import bayeshunt as bh
from bayeshunt.cli import main


def run(monkeypatch, *words):
    monkeypatch.setattr("sys.argv", ["bayeshunt", *map(str, words)])
    with pytest.raises(SystemExit) as left:
        main()
    return left.value.code


def test_bins_and_gait_prior_are_those_of_python(monkeypatch, tmp_path, khepera_frame):
    data, out = tmp_path / "b.parquet", tmp_path / "m.json"
    robot = bh.load_robot("khepera")
    bh.save_dataset(khepera_frame, data)
    options = ["--distance-bin", 0.2, "--angle-bins", 12, "--heading-bins", 18, "--gait-prior", "empirical"]
    assert run(monkeypatch, "fit", data, "--out", out, "--robot", "khepera", "-q", *options) == 0
    axes = bh.EffectAxes.standard(robot.gaits.body_length, distance_bin=0.2, angle_bins=12, heading_bins=18)
    assert bh.ForwardModel.load(out) == bh.ForwardModel.fit(khepera_frame, robot, axes=axes, gait_prior="empirical")


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--distance-bin", 0], "width must be positive"),
        (["--distance-bin", "nan"], "distance_bin: expected a finite number"),
        (["--angle-bins", 0], "angle-bins"),
        (["--gait-prior", "flat"], "gait_prior is 'flat'"),
    ],
)
def test_wrong_options_are_one_line(monkeypatch, capfd, tmp_path, khepera_frame, options, says):
    bh.save_dataset(khepera_frame, tmp_path / "b.parquet")
    line = ["fit", tmp_path / "b.parquet", "--out", tmp_path / "m.json", "--robot", "khepera", "-q", *options]
    assert run(monkeypatch, *line) == 2
    err = capfd.readouterr().err
    assert says in err
    assert err.count("\n") == 1


def test_the_hint_after_few_steps_works(monkeypatch, capfd, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert run(monkeypatch, "babble", "--steps", 5, "--out", "b.parquet", "-q") == 0
    said = capfd.readouterr().out
    assert "gaits; babble more, or fit with a prior)" in said
    hint = said.split("next: bayeshunt ")[1].split("   (")[0].split()
    assert run(monkeypatch, *hint) == 0
