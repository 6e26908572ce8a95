"""A spec read once, and again with other values: what hangs on none of them is kept.

While the spec is read for the first time, it is written down what every entry, table and rule looks up (lookups.py):
names of parameters and of tables, types of joints, blocks of the document. With other values it is read by the same
code; an entry whose data are as they were, and for which every lookup would give what it gave, is the entry that it
was. So are a rule's verdict and what a part of the document means. What is kept is that of the first reading alone, so
that no variant hangs on another one. Beside it stands what follows from it and is the same whoever asks first: what is
to be done again for a set of lookups that differ, and how a number is calculated from parameters.
Where anything is wrong with a variant, it is read once more with nothing kept, and its errors are those.

Impure: reads the spec's file and those of its tables, when it is made; a table that a variant changes is read again.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path

from heuncli.base.errors import SpecError
from heuncli.base.nearest import begin_file
from heuncli.scene.file_format.first_reading import FirstReading
from heuncli.scene.file_format.later_reading import LaterReading
from heuncli.scene.file_format.load import Loading
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.source import read


class SpecVariants:
    """A spec that was read, of which variants are read."""

    def __init__(
        self,
        path: str | Path,
        text: str | None = None,
        overrides: Mapping[str, str] | None = None,
        checking: bool = True,
        case: str | None = None,
        files: NamedFiles | None = None,
    ) -> None:
        """Read the spec as `load` does; overrides: those of all variants; files: those it names. Raises SpecError."""
        begin_file()
        self.overrides = dict(overrides or {})
        source = read(str(path), text)
        self._first = FirstReading(str(path), source, self.overrides, checking, case, files)
        self.spec = self._first.spec()

    def load(self, overrides: Mapping[str, str]) -> Spec:
        """The scene with other values: what `load` makes of the spec with them, and of its values the same bits.

        overrides: parameters or dotted keys with their values as text. Values that are those of the first reading are
        the same objects. Raises SpecError with all problems.
        """
        first, given = self._first, {**self.overrides, **overrides}
        try:
            return LaterReading(first, given).spec()
        except SpecError:
            begin_file()
            return Loading(first.path, first.source, given, first.checking, first.case, first.files).spec()

    def idle(self, names: Collection[str]) -> frozenset[str]:
        """The parameters among some names which no entry and no table looks up, nor another parameter that one does.

        What is expected of the results does not count.
        """
        first = self._first
        read = [kept.lookups for path, kept in first.entries.items() if path[:1] != ("expect",)]
        read += [kept.lookups for kept in first.built.values()]
        used: set[object] = set()
        waiting: set[object] = {lookup.key for lookups in read for lookup in lookups if lookup.of == "parameters"}
        while waiting:
            used |= waiting
            waiting = {name for one in waiting for name in first.known.uses.get(str(one), ())} - used
        return frozenset(name for name in names if name in first.known.uses and name not in used)
