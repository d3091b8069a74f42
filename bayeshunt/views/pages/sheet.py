"""A sheet as a page of its own: no script at all, nothing from elsewhere."""

from __future__ import annotations

from bayeshunt.views.pages.page import render
from bayeshunt.views.sheets.sheet import Sheet

__all__ = ["sheet_html"]


def sheet_html(sheet: Sheet) -> str:
    """Return a self-contained page that shows a sheet."""
    from markupsafe import Markup

    return render("sheet.html.j2", ["page.css"], [], title=sheet.title, card=Markup(sheet.html()))
