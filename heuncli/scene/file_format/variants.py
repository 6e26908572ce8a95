"""Read a spec once, and then again with other values, reusing everything that does not depend on them.

The first reading records what every entry, table and rule looks up (lookups.py): names of parameters and tables, types
of joints, blocks of the document. With other values the spec is read by the same code. An entry is reused if its data
are unchanged and every recorded lookup gives the same value. The same holds for the verdict of a rule and for the
resolved meaning of a part of the document. Only results of the first reading are reused, so that no variant depends on
another one. Cached besides are results that do not depend on the order of the variants: what must be read again for a
given set of changed lookups, and how a number is calculated from parameters. If a variant has an error, it is read once
more without any reuse, and the errors of that reading are reported.

Impure: reads the spec's file and its tables when it is created; a table that a variant changes is read again.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path

from heuncli.base.errors import SpecError
from heuncli.base.spelling import reset_effort
from heuncli.scene.file_format.incremental_loader import IncrementalLoader
from heuncli.scene.file_format.load import SpecLoader
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.quantity import ParameterValue
from heuncli.scene.file_format.recording_loader import RecordingLoader
from heuncli.scene.file_format.source import read_source


class SpecVariants:
    """A spec that was read once and whose variants can be read quickly."""

    def __init__(
        self,
        path: str | Path,
        text: str | None = None,
        overrides: Mapping[str, ParameterValue] | None = None,
        checking: bool = True,
        case: str | None = None,
        files: NamedFiles | None = None,
    ) -> None:
        """Read the spec like `load`.

        overrides: values that hold in all variants
        files: the files that the spec names

        Raises SpecError.
        """
        reset_effort()
        self.overrides = dict(overrides or {})
        source = read_source(str(path), text)
        self._first = RecordingLoader(str(path), source, self.overrides, checking, case, files)
        self.spec = self._first.load_spec()

    def load(self, overrides: Mapping[str, ParameterValue]) -> Spec:
        """Load the scene with other values; the result equals that of a plain `load`, bit by bit.

        overrides: parameters or dotted keys with their values

        Values that are unchanged from the first reading are the same objects. Raises SpecError with all problems.
        """
        first, all_overrides = self._first, {**self.overrides, **overrides}
        try:
            return IncrementalLoader(first, all_overrides).load_spec()
        except SpecError:
            reset_effort()
            return SpecLoader(
                first.path, first.source, all_overrides, first.checking, first.case, first.files
            ).load_spec()

    def unused_parameters(self, names: Collection[str]) -> frozenset[str]:
        """Return the parameters among `names` that no entry and no table uses, directly or through another parameter.

        Expectations do not count.
        """
        first = self._first
        lookup_sets = [record.lookups for path, record in first.entry_records.items() if path[:1] != ("expect",)]
        lookup_sets += [record.lookups for record in first.table_records.values()]
        used: set[object] = set()
        pending: set[object] = {
            lookup.key for lookups in lookup_sets for lookup in lookups if lookup.container == "parameters"
        }
        while pending:
            used |= pending
            pending = {
                name for parameter in pending for name in first.evaluated_parameters.uses.get(str(parameter), ())
            } - used
        return frozenset(name for name in names if name in first.evaluated_parameters.uses and name not in used)
