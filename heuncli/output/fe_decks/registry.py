"""The formats of load cases, a row each. A new one is a module of this folder and a row here.

For a format, say ansys, its module has `write_ansys(cases, names)`, which yields the text in pieces; and
`list_ansys_notes(cases, names)` if there is something that the user has to know.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from importlib import import_module
from typing import Any

from heuncli.analyses.load_cases.model import LoadCases
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.fe_decks.parts import DeckNames


class Deck(NamedTuple):
    """A format: its name, the module that writes it, and whether it holds only forces, as decks of static loads do."""

    name: str
    module: str
    static: bool = True

    def iter_text(self, cases: LoadCases, names: DeckNames) -> Iterable[str]:
        """Yield the text, in pieces."""
        pieces: Iterable[str] = getattr(self._import_module(), f"write_{self.name}")(cases, names)
        return pieces

    def notes(self, cases: LoadCases, names: DeckNames) -> list[str]:
        """Return sentences on steps that the user must do by hand after import."""
        function = f"list_{self.name}_notes"
        list_notes: Callable[[LoadCases, DeckNames], list[str]] | None = getattr(self._import_module(), function, None)
        return list_notes(cases, names) if list_notes is not None else []

    def _import_module(self) -> Any:
        return import_module(f"heuncli.output.fe_decks.{self.module}")


ROWS = (
    Deck("csv", "plain_data", static=False),
    Deck("json", "plain_data", static=False),
    Deck("ansys", "ansys"),
    Deck("nastran", "nastran"),
    Deck("calculix", "abaqus"),
    Deck("abaqus", "abaqus"),
)
DECKS = {row.name: row for row in ROWS}
