"""A structure of a user's own, under its own name."""

import pytest

import bayeshunt as bh

EDGES = (("Gait", "Distance"), ("Gait", "Angle"), ("Gait", "Heading"), ("Angle", "Heading"))
TEXT = "arc: Gait->Distance, Gait -> Angle, Gait->Heading, Angle->Heading"


def test_its_name_stays_with_model_file_and_results(khepera_frame, tmp_path):
    robot = bh.load_robot("khepera")
    model = bh.ForwardModel.fit(khepera_frame, robot.gaits, structure=bh.Structure("arc", EDGES))
    model.save(tmp_path / "arc.json")
    again = bh.ForwardModel.load(tmp_path / "arc.json")
    assert again == model
    assert again.structure == bh.Structure("arc", EDGES)
    assert again.structure.describe() == "P(Distance | Gait) P(Angle | Gait) P(Heading | Angle, Gait)"
    results = bh.evaluate("paper", runs=1, seed=0, planners=["reactive"], arenas=["open"], model=again, jobs=1)
    assert results.attrs["structure"] == "arc"


def test_a_line_of_text_describes_one():
    assert bh.Structure.read(TEXT) == bh.Structure("arc", EDGES)


@pytest.mark.parametrize("text", ["arc", "arc:", "arc: Gait->Angle->Heading", "Gait->Angle"])
def test_other_texts_are_refused_with_an_example(text):
    with pytest.raises(bh.InputError, match="expected a name and edges, 'arc: Gait->Distance"):
        bh.Structure.read(text)


@pytest.mark.parametrize("name", ["naiv", "tann", "Joint"])
def test_a_shipped_name_misspelt_is_not_a_name_of_ones_own(name):
    with pytest.raises(bh.InputError, match="did you mean"):
        bh.Structure(name, EDGES)


@pytest.mark.parametrize("name", ["learnt_by_hand", "my tan"])
def test_other_names_are(name):
    assert bh.Structure(name, EDGES).name == name


def test_a_name_is_a_word():
    for name in ("", " arc", "a\nb"):
        with pytest.raises(bh.InputError, match="name: expected a word of your own"):
            bh.Structure(name, EDGES)


def test_fit_takes_it(bayeshunt, khepera_frame, folder):
    bh.save_dataset(khepera_frame, folder / "b.parquet")
    bayeshunt("fit", "b.parquet", "--structure", TEXT, "--out", "arc.json", "--json")
    assert bh.ForwardModel.load(folder / "arc.json").structure.name == "arc"
    _, err = bayeshunt("fit", "b.parquet", "--structure", "arc: Gait->Speed", "--out", "no.json", status=2)
    assert "the edge Gait -> Speed is not allowed" in err
    assert not (folder / "no.json").exists()
