"""The formats of load cases, a row each. A new one is a module of this folder and a row here.

A module has `written(cases, names)`, which yields the text in pieces; and `notes(cases, names)` if there is something
that the user has to know.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from importlib import import_module
from typing import Any

from heuncli.analyses.load_cases.model import LoadCases
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.fe_decks.naming import DeckNames


class Deck(NamedTuple):
    """A format: the module that writes it, and whether it holds only forces, as decks of static loads do."""

    file: str
    static: bool = True

    def iter_text(self, cases: LoadCases, names: DeckNames) -> Iterable[str]:
        """Yield the text, in pieces."""
        pieces: Iterable[str] = self._module.written(cases, names)
        return pieces

    def notes(self, cases: LoadCases, names: DeckNames) -> list[str]:
        """Return sentences on steps that the user must do by hand after import."""
        module_notes: Callable[[LoadCases, DeckNames], list[str]] | None = getattr(self._module, "notes", None)
        return module_notes(cases, names) if module_notes is not None else []

    @property
    def _module(self) -> Any:
        return import_module(f"heuncli.output.fe_decks.{self.file}")


DECKS = {
    "csv": Deck("as_csv", static=False),
    "json": Deck("as_json", static=False),
    "ansys": Deck("ansys"),
    "nastran": Deck("nastran"),
    "calculix": Deck("calculix"),
    "abaqus": Deck("abaqus"),
}
