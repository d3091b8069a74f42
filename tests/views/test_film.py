"""A hunt as a film."""

import matplotlib as mpl
import pytest
from PIL import Image

import bayeshunt as bh
from bayeshunt.views.figures.film import film


@pytest.fixture(scope="module")
def episode(khepera_model):
    settings = bh.load_experiment("paper", {"protocol.time_limit": 10.0})
    return bh.hunt(settings, bh.make_planner("reactive", khepera_model), arena="walled", theta=1.0, seed=0)


def test_a_gif_lasts_as_long_as_the_hunt_at_its_speed(episode, tmp_path):
    film(episode, tmp_path / "hunt.gif", speed=20)
    with Image.open(tmp_path / "hunt.gif") as shown:
        frames = [shown.seek(i) or shown.info["duration"] for i in range(shown.n_frames)]  # frames alike are one
    seconds = sum(frames) / 1000
    assert len(frames) >= 6
    assert seconds == pytest.approx(episode.trail["time"].iloc[-1] / 20 + 1, abs=0.3)
    assert [path.name for path in tmp_path.iterdir()] == ["hunt.gif"]


def test_what_is_no_film_is_refused_before_any_work(episode, tmp_path):
    with pytest.raises(bh.InputError, match=r"\.gif or \.mp4"):
        film(episode, tmp_path / "hunt.avi")
    with pytest.raises(bh.InputError, match="speed"):
        film(episode, tmp_path / "hunt.gif", speed=0)


def test_an_mp4_needs_ffmpeg_and_says_so(episode, tmp_path, monkeypatch):
    monkeypatch.setattr("bayeshunt.views.figures.film.shutil.which", lambda name: None)
    monkeypatch.setattr("bayeshunt.views.figures.film.find_spec", lambda name: None)
    with pytest.raises(bh.InputError, match=r"needs ffmpeg.*hunt\.gif"):
        film(episode, tmp_path / "hunt.mp4")
    assert list(tmp_path.iterdir()) == []


def test_an_mp4_leaves_the_settings_of_matplotlib_as_they_were(episode, tmp_path):
    pytest.importorskip("imageio_ffmpeg", reason="imageio-ffmpeg is not installed (extra: film)")
    before = dict(mpl.rcParams)
    film(episode, tmp_path / "hunt.mp4", speed=20)
    assert (tmp_path / "hunt.mp4").stat().st_size > 1000
    assert dict(mpl.rcParams) == before
