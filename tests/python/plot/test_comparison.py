"""Several contacts in one picture, under names that people give."""

from __future__ import annotations

import pytest
import quasirigid as qr
from quasirigid import plot

pytest.importorskip("matplotlib")


def test_names_are_no_formulas(pressed: qr.Contact) -> None:
    names = [r"v$\x$", "for $5 or $6"]
    figure = plot.comparison_figure(dict.fromkeys(names, pressed))
    figure.draw_without_rendering()
    titles = [ax.title for ax in figure.axes[:2]]
    assert [title.get_text().splitlines()[0] for title in titles] == names
    assert not any(title.get_parse_math() for title in titles)


@pytest.mark.parametrize("name", ["a long name of a product " * 4, "A" * 300])
def test_long_names_stay_within_the_picture(pressed: qr.Contact, name: str) -> None:
    figure = plot.comparison_figure({name: pressed})
    figure.draw_without_rendering()
    ax = figure.axes[0]
    assert ax.title.get_text().startswith(name[:20])
    box = ax.title.get_window_extent()
    assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1
    assert box.y1 <= figure.bbox.y1


@pytest.mark.parametrize(("count", "rows", "columns"), [(1, 1, 1), (4, 1, 4), (5, 2, 3), (9, 3, 3)])
def test_many_footprints_stand_in_rows(pressed: qr.Contact, count: int, rows: int, columns: int) -> None:
    figure = plot.comparison_figure({str(number): pressed for number in range(count)})
    panels = [ax for ax in figure.axes if ax.get_title()]
    assert [ax.get_title().splitlines()[0] for ax in panels] == [str(number) for number in range(count)]
    figure.draw_without_rendering()
    places = [ax.get_position() for ax in panels]
    assert len({round(place.y0, 2) for place in places}) == rows
    assert len({round(place.x0, 2) for place in places}) == columns
    # All of them say where they are.
    assert all(any(label.get_text() for label in ax.get_xticklabels()) for ax in panels)


def test_contacts_without_force_are_compared(apart: qr.Contact, unsolved: qr.Contact) -> None:
    figure = plot.comparison_figure({"apart": apart, "unsolved": unsolved})
    figure.draw_without_rendering()
    assert [ax.texts[0].get_text() for ax in figure.axes] == ["no pressure", "no pressure"]
