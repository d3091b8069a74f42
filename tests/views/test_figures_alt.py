"""A described figure: the picture and the words in its place, shown once."""

import base64

import pytest
from matplotlib.figure import Figure

from bayeshunt.core.errors import InputError
from bayeshunt.views import figures


def test_the_picture_has_its_words():
    figure = Figure(figsize=(2, 1))
    figure.subplots().plot([1, 2])
    shown = figures.described(figure, 'A line that rises from "1" to 2 <slowly>.')
    page = shown._repr_html_()
    assert page.startswith('<img alt="A line that rises from &quot;1&quot; to 2 &lt;slowly&gt;."')
    assert "</img>" not in page
    drawn = base64.b64decode(page.split("base64,")[1].split('"')[0])
    assert drawn.startswith(b"\x89PNG")
    assert 'width="192"' in page
    with pytest.raises(InputError, match="words"):
        figures.described(figure, " ")


def test_pyplot_does_not_show_it_again():
    plt = pytest.importorskip("matplotlib.pyplot")
    figure, _ = plt.subplots()
    figures.described(figure, "Empty axes.")
    assert not plt.fignum_exists(figure.number)


def test_a_described_figure_is_written_like_any_other(tmp_path):
    figure = Figure()
    figure.subplots().plot([0, 1])
    shown = figures.described(figure, "a line")
    shown.savefig(tmp_path / "line.svg", metadata={"Date": None})
    assert "<svg" in (tmp_path / "line.svg").read_text()
    assert type(shown._repr_html_()) is str


def test_a_kind_of_file_that_is_no_figure_is_refused(tmp_path):
    shown = figures.described(Figure(), "nothing drawn")
    with pytest.raises(InputError, match="not written as 'csv'; expected one of"):
        shown.savefig(tmp_path / "line.csv")
    assert not list(tmp_path.iterdir())
