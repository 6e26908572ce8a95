"""Show the section of the manual that treats a word, and what to type to see the other ones."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.app.commands.explain.lookup import Place, Row, find_places, find_terms
from heuncli.app.commands.explain.pages import find_section, make_request, read_page
from heuncli.app.commands.explain.paths import explain_path

MAX_ALSO = 8


def explain_word(word: str) -> str | None:
    """Return the section that treats a word, and a list of the others; None if the word is unknown."""
    places = find_places(word)
    if not places:
        return None
    main, *others = places
    end = "" if main.path else f"\nThis is from: {make_request(main.page)}\n"
    return "".join(map(show_term, find_terms(word, main))) + read_place(main) + end + list_requests(others)


def list_requests(places: Sequence[Place]) -> str:
    """List what to type to see other places; nothing if there are none."""
    return "\nSee also:\n" + "".join(f"  {place.request}\n" for place in places[:MAX_ALSO]) if places else ""


def show_term(row: Row) -> str:
    """Return a row of the page of words: the term and what it is in heun."""
    meaning, _, _ = row.text.rpartition(" | ")
    return f"term     {row.name}\nin heun  {meaning}\n\n"


def read_place(place: Place) -> str:
    """Return the text of a page, a section or the explanation of a path."""
    if place.path:
        return explain_path(place.path) or read_page("results")
    section = find_section(place.page, place.heading) if place.heading else None
    return read_page(place.page) if section is None else section.text
