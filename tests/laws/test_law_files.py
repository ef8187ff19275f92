"""Folders of laws: one law, and the laws of a mixture."""

import pytest

from restitution.errors import OutputError
from restitution.laws.law_files import is_mixture, read_laws, write_law


@pytest.fixture
def mixture(law, tmp_path):
    """A complete mixture of two pairs."""
    folder = tmp_path / "mixture"
    (folder / "laws").mkdir(parents=True)
    for name in ("mixture.toml", "summary.json"):
        (folder / name).write_text("")
    for title in ("b", "a"):
        write_law(law(title=title), folder / "laws" / title)
    return folder


def test_the_laws_of_a_mixture_are_read_in_the_order_of_their_names(law, mixture, tmp_path):
    single = tmp_path / "single"
    write_law(law(title="alone"), single)
    assert (is_mixture(mixture), is_mixture(single)) == (True, False)
    assert [each.title for each in read_laws([mixture, single])] == ["a", "b", "alone"]


@pytest.mark.parametrize("missing", ["laws", "summary.json"])
def test_a_mixture_without_its_laws_or_its_summary_is_not_complete(mixture, missing):
    (mixture / missing).rename(mixture / "elsewhere")
    with pytest.raises(OutputError, match="the mixture is not complete; finish it with"):
        read_laws([mixture])
