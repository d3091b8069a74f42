"""The model file: bit-exact there and back; anything else is one clear line."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from model_cases import babbled, random_model, repertoire

from bayeshunt.core.errors import BayesHuntError, InputError, ModelFileError
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.formats import model_file


@pytest.fixture
def path(model: ForwardModel, tmp_path: Path) -> Path:
    model.save(tmp_path / "model.json")
    return tmp_path / "model.json"


def refused(path: Path) -> str:
    """The one line that loading ends in."""
    with pytest.raises(ModelFileError) as caught:
        ForwardModel.load(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert isinstance(caught.value, InputError)
    return message


def test_round_trip_is_bit_exact(model: ForwardModel, path: Path) -> None:
    loaded = ForwardModel.load(path)
    assert loaded == model
    assert loaded.gaits == model.gaits
    assert loaded.provenance == model.provenance
    for variable in ("Gait", "Distance", "Angle", "Heading"):
        assert np.array_equal(loaded.probabilities(variable), model.probabilities(variable))
    assert np.array_equal(loaded.mean_paths, model.mean_paths)
    assert model_file.dumps(loaded) == path.read_text()


@pytest.mark.parametrize("seed", range(20))
def test_round_trip_of_random_models(seed: int) -> None:
    model = random_model(seed)
    assert ForwardModel.loads(model_file.dumps(model)) == model


def test_empty_model_and_awkward_numbers_round_trip(tmp_path: Path) -> None:
    empty = ForwardModel.empty(repertoire(), 0.1 + 0.2)
    empty.save(tmp_path / "empty.json")
    assert ForwardModel.load(tmp_path / "empty.json") == empty
    assert ForwardModel.load(tmp_path / "empty.json").prior == 0.1 + 0.2


def test_loaded_model_updates_like_the_original(model: ForwardModel, path: Path) -> None:
    more = babbled(40, seed=9, points=3)
    assert ForwardModel.load(path).update(more) == model.update(more)


def test_same_rows_in_any_order_give_the_same_bytes(tmp_path: Path) -> None:
    frame = babbled(200, seed=2)
    texts = {
        model_file.dumps(ForwardModel.fit(rows, repertoire(), prior=0.5))
        for rows in (frame, frame.iloc[::-1], frame.sample(frac=1.0, random_state=1))
    }
    assert len(texts) == 1


def test_probabilities_can_be_read_from_the_file(model: ForwardModel, path: Path) -> None:
    content = json.loads(path.read_text())["content"]
    assert content["axes"]["Angle"]["labels"] == list(model.axes.angle.labels)
    assert content["cells_columns"] == ["Gait", "Distance", "Angle", "Heading", "count"]
    assert sum(row[-1] for row in content["cells"]) == model.joint.total
    assert content["gaits"][1] == {"name": "soft right", "command": [0.0576, 0.0432]}


def test_missing_file(tmp_path: Path) -> None:
    assert "no such file" in refused(tmp_path / "none.json")
    assert "is a folder" in refused(tmp_path)


@pytest.mark.parametrize("keep", [0, 1, 100, -5])
def test_truncated(path: Path, keep: int) -> None:
    path.write_text(path.read_text()[:keep])
    assert "not JSON, damaged or cut short" in refused(path)


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"PAR1....", b"[1, 2]", b"{}", b'{"kind": "other"}', b"NaN"])
def test_other_files(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    assert "not" in refused(path)


def test_edited(path: Path) -> None:
    text = path.read_text()
    path.write_text(text.replace('"prior": 0.0', '"prior": 1.0'))
    assert path.read_text() != text
    assert "checksum does not match" in refused(path)


def test_layout_is_not_checksummed(model: ForwardModel, path: Path) -> None:
    path.write_text(json.dumps(json.loads(path.read_text()), indent=4))
    assert ForwardModel.load(path) == model


@pytest.mark.parametrize(
    ("version", "says"), [(8, "newer"), (0, "expected 1"), ("1", "expected 1"), (None, "expected")]
)
def test_other_formats(path: Path, version: object, says: str) -> None:
    record = json.loads(path.read_text())
    path.write_text(json.dumps({**record, "format": version}))
    assert says in refused(path)


EDITS: dict[str, Callable[[dict], object]] = {
    "no gaits": lambda c: c["gaits"].clear(),
    "gait twice": lambda c: c["gaits"].__setitem__(1, c["gaits"][0]),
    "no axes": lambda c: c.pop("axes"),
    "negative count": lambda c: c["cells"][0].__setitem__(4, -1),
    "half a count": lambda c: c["cells"][0].__setitem__(4, 0.5),
    "huge count": lambda c: c["cells"][0].__setitem__(4, 1 << 70),
    "outside": lambda c: c["cells"][-1].__setitem__(0, 99),
    "unsorted": lambda c: c["cells"].reverse(),
    "ragged": lambda c: c["cells"][0].pop(),
    "bad prior": lambda c: c.update(prior=-1.0),
    "text prior": lambda c: c.update(prior="0"),
    "gait prior": lambda c: c.update(gait_prior="flat"),
    "label": lambda c: c["axes"]["Angle"]["labels"].__setitem__(0, "0 deg"),
    "bins": lambda c: c["axes"]["Distance"].update(bins=10**9),
    "pose sums": lambda c: c["pose_sums"].pop(),
    "not a dict": lambda c: c.update(provenance=3),
}


@pytest.mark.parametrize("name", EDITS)
def test_resealed_but_malformed(path: Path, name: str) -> None:
    record = json.loads(path.read_text())
    EDITS[name](record["content"])
    record["checksum"] = model_file._checksum(record["content"])
    path.write_text(json.dumps(record))
    assert "malformed content" in refused(path)


def test_failed_save_leaves_the_old_file(
    model: ForwardModel, path: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    before = path.read_bytes()
    monkeypatch.setattr(model_file, "load", lambda _: ForwardModel.empty(model.gaits))
    with pytest.raises(BayesHuntError, match="did not come back"):
        model.save(path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["model.json"]


def test_folder_missing_and_provenance_not_json(model: ForwardModel, tmp_path: Path) -> None:
    with pytest.raises(BayesHuntError, match="cannot write here"):
        model.save(tmp_path / "nowhere" / "model.json")
    odd = ForwardModel(model.joint, provenance={"sources": [{"seed": float("nan")}]})
    with pytest.raises(BayesHuntError, match="provenance cannot be stored"):
        odd.save(tmp_path / "odd.json")
    assert list(tmp_path.iterdir()) == []
