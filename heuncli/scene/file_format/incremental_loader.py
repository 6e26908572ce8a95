"""Read a spec once, and then again with other values, reusing everything that does not depend on them.

The first reading (recording_loader.py) records what every entry, table and rule looks up (lookups.py): names of
parameters and tables, types of joints, blocks of the document. With other values the spec is read by the same code. An
entry is reused if its data are unchanged and every recorded lookup gives the same value. The same holds for the verdict
of a rule and for the resolved meaning of a part of the document. Only results of the first reading are reused, so that
no variant depends on another one. Cached besides are results that do not depend on the order of the variants: what must
be read again for a given set of changed lookups, and how a number is calculated from parameters. If a variant has an
error, it is read once more without any reuse, and the errors of that reading are reported.

Impure: reads the spec's file and its tables when it is created; a table that a variant changes is read again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from heuncli.base.errors import SourceLocation
from heuncli.base.records import replace
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.expressions.scope import DimensionedParameter
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.document import DocumentReader
from heuncli.scene.file_format.entries import Entry
from heuncli.scene.file_format.fields import ReadContext
from heuncli.scene.file_format.load import SpecLoader
from heuncli.scene.file_format.lookups import Lookup, iter_changed, iter_changed_in_document
from heuncli.scene.file_format.models import Logo, Spec
from heuncli.scene.file_format.names import SceneNames, as_mapping
from heuncli.scene.file_format.parameters import Parameters, evaluate_parameters
from heuncli.scene.file_format.quantity import ParameterValue, Scope
from heuncli.scene.file_format.recording_loader import RecordingLoader
from heuncli.scene.file_format.resolve import ResolveInputs, Resolver, resolve
from heuncli.scene.file_format.rules.every import DraftDocument, Rule, Violation
from heuncli.scene.file_format.sharing import is_same, reuse_entries, reuse_if_same
from heuncli.scene.file_format.source import Path_, format_path
from heuncli.scene.file_format.tables import TableProblem

if TYPE_CHECKING:
    from heuncli.scene.meshes.model import TriangleMesh
from collections.abc import Collection
from pathlib import Path

from heuncli.base.errors import SpecError
from heuncli.base.spelling import reset_effort
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.source import read_source

WHOLE_FIELDS = (
    "title",
    "space",
    "gravity",
    "ground",
    "report",
    "foundation",
    "expect",
    "cases",
    "labels",
    "warnings",
)  # fields of a scene that are reused as a whole or not at all


class IncrementalLoader(SpecLoader):
    """Loads a spec with other values and reuses what is unchanged from the first loading."""

    def __init__(self, first: RecordingLoader, overrides: Mapping[str, ParameterValue]) -> None:
        self.first = first
        super().__init__(first.path, first.source, overrides, first.checking, first.case, first.files)

    def complete_data(self, data: dict[str, Any]) -> dict[str, Any]:
        """Return the data to read, with unchanged blocks and entries taken from the first loading."""
        first_data, set_blocks = (
            self.first.data,
            {path[0] for path in (*self.override_locations, *self.first.override_locations)},
        )
        self.by_parameters = set_blocks <= {"parameters"}
        if self.by_parameters:  # parameters do not change the rest of the data
            return {**first_data, **{block: value for block, value in data.items() if block in set_blocks}}
        return _reuse_data(super().complete_data(data), first_data)

    def resolve_document(self, document: f.Document, meaning: ResolveInputs) -> Spec:
        """Resolve the document into a scene, with unchanged values taken from the first one."""
        first_spec = self.first.resolved
        resolved = resolve(document, meaning, IncrementalResolver(self, document, meaning))
        others = {name: reuse_if_same(getattr(resolved, name), getattr(first_spec, name)) for name in WHOLE_FIELDS}
        tables = reuse_entries(resolved.tables, first_spec.tables)
        return resolved._replace(
            tables=tables, parameters=reuse_entries(resolved.parameters, first_spec.parameters), **others
        )

    def collect_names(self) -> SceneNames:
        """Collect everything that the spec names; if only parameters differ, reuse the names of the first loading."""
        if not self.by_parameters:
            return super().collect_names()
        first_names = self.first.first_names
        entries = {**first_names.entries, "parameters": as_mapping(self.data.get("parameters"))}
        return SceneNames(entries, first_names.points, first_names.joints, {})

    def evaluate_parameter_block(self) -> Parameters:
        """Evaluate the parameters that have changed or depend on one that has."""
        block = self.get_block("parameters")
        return evaluate_parameters(
            block, _select_unchanged(block, self.first.given_parameters, self.first.evaluated_parameters)
        )

    def make_scope(
        self, parameters: Mapping[str, float | None], given_parameters: Mapping[str, DimensionedParameter]
    ) -> Scope:
        """Make the scope of names that a number may use; if the names are those of the first loading, reuse its
        calculations.
        """
        same_names = self.by_parameters and parameters.keys() == self.first.evaluated_parameters.values.keys()
        calculations = self.first.calculations if same_names else None
        return replace(super().make_scope(parameters, given_parameters), calculations=calculations)

    def make_reader(self, context: ReadContext) -> DocumentReader:
        """Make a reader that reuses entries of the first loading."""
        return IncrementalReader(self, context, frozenset(self._iter_changed_lookups(context)))

    def _iter_changed_lookups(self, context: ReadContext) -> Iterator[Lookup]:
        """Yield the lookups of entries and tables that now give another value."""
        first_context = self.first.contexts[context.time.in_time]
        for name in ("parameters", "given", "joints", "tables"):
            new, old = (getattr(each_context.time, name) for each_context in (context, first_context))
            yield from iter_changed(name, reuse_entries(new, old), old)
        yield from iter_changed("points", reuse_entries(context.points, first_context.points), first_context.points)

    def build_entry_table(
        self, name: str, entry: f.TableEntry, scope: Scope
    ) -> tuple[TableFunction | None, list[TableProblem]]:
        """Return the table of an entry, and what is wrong with it; reuse the first one if it is unchanged."""
        record = self.first.table_records.get(name)
        if record is not None and record.entry is entry:
            differing = frozenset(self._iter_changed_lookups(ReadContext(scope, scope)))
            if record.lookups.isdisjoint(differing):
                return record.table, record.findings
        return super().build_entry_table(name, entry, scope)

    def load_mesh(self, file: str) -> tuple[TriangleMesh | None, list[TableProblem]]:
        """Return the mesh of a file; it is read once for all variants."""
        mesh = self.first.first_meshes.get(file)
        return (mesh, []) if mesh is not None else super().load_mesh(file)

    def load_logo(self, document: f.Document) -> Logo | None:
        """Return the logo of the report; it is read once for all variants."""
        report, first_logo = document.head.report, self.first.resolved.report.logo
        is_first = isinstance(report, f.ReportEntry) and first_logo is not None and report.logo == first_logo.name
        return first_logo if is_first else super().load_logo(document)

    def iter_violations(self, draft: DraftDocument) -> Iterator[tuple[Rule, Violation]]:
        """Yield the violations of the active rules; apply only the rules whose verdict may have changed."""
        self.differing_lookups = frozenset(self._iter_differing_lookups(draft))
        plan = self.first.plan_verdicts(self.differing_lookups)
        draft.path_targets.update(plan.path_targets)
        for rule, recorded in plan.verdicts:
            found = rule.check(draft) if recorded is None else recorded
            yield from ((rule, violation) for violation in found)

    def _iter_differing_lookups(self, draft: DraftDocument) -> Iterator[Lookup]:
        """Yield the lookups of rules that now give another value."""
        first_draft = self.first.draft
        yield from iter_changed("unread", dict.fromkeys(draft.unread), dict.fromkeys(first_draft.unread))
        for name in ("points", "joints"):
            new, old = getattr(draft.names, name), getattr(first_draft.names, name)
            yield from iter_changed(f"names.{name}", reuse_entries(new, old), old)
        for block, entries in draft.names.entries.items():
            yield from iter_changed(f"names.entries.{block}", entries, first_draft.names.entries[block])
        yield from iter_changed_in_document("document", draft.document, first_draft.document)

    def collect_locations(self) -> dict[str, SourceLocation]:
        """Collect the locations for later stages: those of the first loading, updated for paths that either loading
        overrides.
        """
        set_paths = frozenset({*self.override_locations, *self.first.override_locations})
        moved = self.locate_paths((*self.first.find_paths_below(set_paths), *self.override_locations))
        removed = {format_path(path) for path in self.first.override_locations}
        self.moved_paths = moved.keys() | removed
        if not removed:
            return {**self.first.first_locations, **moved}
        return {
            words: location for words, location in self.first.first_locations.items() if words not in removed
        } | moved


class IncrementalResolver(Resolver):
    """Resolves references only where something has changed that a part of the scene depends on."""

    def __init__(self, later: IncrementalLoader, document: f.Document, meaning: ResolveInputs) -> None:
        super().__init__(document, meaning.locations, meaning.curves, meaning.surfaces)
        first = later.first
        self.meaning_records, self.first_spec, self.first_document = (
            first.meaning_records,
            first.resolved,
            first.draft.document,
        )
        curves = iter_changed("curves", meaning.curves, first.first_curves)
        surfaces = iter_changed("surfaces", meaning.surfaces, first.first_meshes)
        moved = (Lookup("locations", words) for words in later.moved_paths)
        self.unchanged_parts = first.find_unchanged_parts(later.differing_lookups.union(moved, curves, surfaces))

    def resolve_entries(self, block: str, method: str) -> dict[Any, Any]:
        """Resolve the entries of a block; reuse the whole block if all its entries are unchanged."""
        resolve_entry, entries, first_block = (
            getattr(self, method),
            getattr(self.document, block),
            getattr(self.first_spec, block),
        )
        if (
            type(first_block) is dict
            and entries is getattr(self.first_document, block)
            and block in self.unchanged_parts.blocks
        ):
            return first_block
        resolved = {
            name: self._reuse_or_resolve((block, name), partial(resolve_entry, name, entry))
            for name, entry in entries.items()
        }
        unchanged = type(first_block) is dict and _is_same_object(resolved, first_block)
        return first_block if unchanged else resolved

    def resolve_single(self, method: str) -> Any:
        """Resolve a part that belongs to the document as a whole."""
        return self._reuse_or_resolve((method, None), getattr(self, method))

    def _reuse_or_resolve(self, key: tuple[str, Any], resolve_part: Callable[[], Any]) -> Any:
        record = self.meaning_records.get(key)
        if record is None:
            return resolve_part()
        return record.value if key in self.unchanged_parts.parts else reuse_if_same(resolve_part(), record.value)


class IncrementalReader(DocumentReader):
    """Reuses entries of the first loading if nothing they depend on has changed."""

    def __init__(self, later: IncrementalLoader, context: ReadContext, changed_lookups: frozenset[Lookup]) -> None:
        super().__init__(later.data, context, later.report)
        self.first, self.changed_lookups, self.by_parameters = later.first, changed_lookups, later.by_parameters

    def read_document(self) -> f.Document:
        """Read every block that can be read; if only parameters differ, read the entries that depend on changed
        ones.
        """
        if not self.by_parameters:
            return super().read_document()
        updated_blocks: dict[str, Any] = {}
        for block, name in self.first.find_changed_entries(self.changed_lookups):
            if block in f.SINGLE_BLOCKS:
                updated_blocks[block] = self.read_single(block, f.SINGLE_BLOCKS[block])
            elif block == "head":
                updated_blocks[block] = self.read_head()
            else:
                entries = updated_blocks.setdefault(block, {**getattr(self.first.document, block)})
                entries[name] = self._reread_entry(block, name)
                if entries[name] is None:
                    del entries[name]
        return self.first.document._replace(**updated_blocks)

    def _reread_entry(self, block: str, name: Any) -> Any:
        """Read an entry again that the first loading has read."""
        data = self.data[block][name]
        if block == "expect":
            return self.read_model((block, name), data, f.ExpectEntry)
        return self.read_entry(block, name, data, f.ENTRY_BLOCKS[block])

    def read_model(self, path: Path_, data: Any, model: type[Entry]) -> Any:
        """Return the entry of the first loading if it is unchanged, else read it."""
        record = self.first.entry_records.get(path)
        has_same_data = record is not None and type(record.entry) is model and is_same(data, record.data)
        if record is not None and has_same_data and record.lookups.isdisjoint(self.changed_lookups):
            return record.entry
        return super().read_model(path, data, model)

    def read_shapes(self, path: Path_, body: f.BodyEntry) -> f.BodyEntry | None:
        """Return the body with its shapes read; the first one if it is unchanged."""
        first_body, first_shaped_body = self.first.shaped_bodies.get(path, (None, None))
        new = super().read_shapes(path, body)
        if (
            new is None
            or first_shaped_body is None
            or body is not first_body
            or not _is_same_object(new.shapes, first_shaped_body.shapes)
        ):
            return new
        return first_shaped_body


def _select_unchanged(block: dict[str, Any], first_block: dict[str, Any], parameters: Parameters) -> Parameters:
    """Select the parameters whose values remain valid: neither they nor any parameter they use has changed."""
    unchanged = {name for name in block if name in first_block and is_same(block[name], first_block[name])}
    unchanged = unchanged if block.keys() == first_block.keys() else set()
    while affected := {name for name in unchanged if not parameters.uses[name] & first_block.keys() <= unchanged}:
        unchanged -= affected
    return Parameters(
        {name: value for name, value in parameters.values.items() if name in unchanged},
        {name: value for name, value in parameters.given_quantities.items() if name in unchanged},
        [],
        {name: value for name, value in parameters.uses.items() if name in unchanged},
    )


def _is_same_object(new: Any, old: Any) -> bool:
    """Whether an entry is the same object, or all entries of a block or list are."""
    if isinstance(new, dict) and isinstance(old, dict):
        return [*new] == [*old] and all(new[key] is old[key] for key in new)
    if isinstance(new, list) and isinstance(old, list):
        return len(new) == len(old) and all(new_item is old_item for new_item, old_item in zip(new, old, strict=True))
    return new is old


def _reuse_data(new: dict[str, Any], old: dict[str, Any]) -> dict[str, Any]:
    """Return new data with unchanged blocks and entries taken from the old data."""
    return {
        block: reuse_entries(value, old[block]) if type(value) is dict and type(old.get(block)) is dict
        else reuse_if_same(value, old.get(block))
        for block, value in new.items()
    }  # fmt: skip


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
