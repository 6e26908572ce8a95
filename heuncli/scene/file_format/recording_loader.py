"""Load a spec and record what each part of it depends on (incremental_loader.py), with the parts themselves.

Impure: reads the spec's tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from typing import Any, cast

from heuncli.base.errors import SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.scene.expressions.codegen import CalculationCache
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.expressions.scope import DimensionedParameter
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.document import DocumentReader
from heuncli.scene.file_format.entries import Entry
from heuncli.scene.file_format.fields import ReadContext
from heuncli.scene.file_format.load import SpecLoader
from heuncli.scene.file_format.lookups import Lookup, LookupLog, WatchedDocument, WatchedMapping
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.names import SceneNames
from heuncli.scene.file_format.parameters import Parameters, evaluate_parameters
from heuncli.scene.file_format.quantity import ParameterValue, Scope
from heuncli.scene.file_format.resolve import ResolveInputs, Resolver, resolve
from heuncli.scene.file_format.rules.every import DraftDocument, Rule, Violation
from heuncli.scene.file_format.sharing import is_same
from heuncli.scene.file_format.source import Path_, SourceFile
from heuncli.scene.file_format.tables import TableProblem

MAX_PLANS = 1024  # cached plans, by the set of differing lookups


class EntryRecord(NamedTuple):
    """An entry with the data it was read from and the lookups that reading made."""

    entry: Any
    data: Any
    lookups: frozenset[Lookup]


class TableRecord(NamedTuple):
    """A table, the entry it was built from, the lookups made for it, and its findings."""

    table: TableFunction | None
    entry: f.TableEntry
    lookups: frozenset[Lookup]
    findings: list[TableProblem]


class VerdictRecord(NamedTuple):
    """The violations that a rule found, and its lookups; None: unknown."""

    violations: tuple[Violation, ...]
    lookups: frozenset[Lookup] | None


class UnchangedParts(NamedTuple):
    """Parts of a scene whose meaning is unchanged, by block and name; and the blocks whose entries are all
    unchanged.
    """

    parts: frozenset[tuple[str, Any]]
    blocks: frozenset[str]


class VerdictPlan(NamedTuple):
    """Rules with the violations they found, None where the rule must be applied again; and the unchanged targets of
    result paths.
    """

    verdicts: list[tuple[Rule, tuple[Violation, ...] | None]]
    path_targets: dict[str, Any]


class MeaningRecord(NamedTuple):
    """A resolved part of the document with the lookups that resolving it made."""

    value: Any
    lookups: frozenset[Lookup]


class RecordingLoader(SpecLoader):
    """Loads a spec and records what each part of it depends on."""

    def __init__(
        self,
        path: str,
        source: SourceFile,
        overrides: Mapping[str, ParameterValue],
        checking: bool,
        case: str | None,
        files: NamedFiles | None,
    ) -> None:
        super().__init__(path, source, overrides, checking, case, files)
        self.log = LookupLog()
        self.entry_records: dict[Path_, EntryRecord] = {}
        self.document: f.Document
        self.shaped_bodies: dict[Path_, tuple[f.BodyEntry, f.BodyEntry]] = {}  # body as read, and with its shapes
        self.table_records: dict[str, TableRecord] = {}
        self.contexts: dict[bool, ReadContext] = {}  # by whether the context allows functions of time
        self.verdict_records: list[VerdictRecord] = []
        self.calculations = CalculationCache()
        self.meaning_records: dict[tuple[str, Any], MeaningRecord] = {}
        self.path_target_records: dict[str, MeaningRecord] = {}
        self.paths_below: dict[frozenset[Path_], list[Path_]] = {}
        self.plans: dict[frozenset[Lookup], VerdictPlan] = {}
        self.unchanged_parts: dict[frozenset[Lookup], UnchangedParts] = {}
        self.rereads: dict[frozenset[Lookup], list[tuple[str, Any]]] = {}

    def load_spec(self) -> Spec:
        """Load the scene. Raises SpecError."""
        self.resolved = super().load_spec()
        return self.resolved

    def resolve_document(self, document: f.Document, meaning: ResolveInputs) -> Spec:
        """Resolve the document into a scene, and record the meaning of every part."""
        self.first_curves, self.first_meshes = meaning.curves, meaning.surfaces
        return resolve(document, meaning, RecordingResolver(self, document, meaning))

    def collect_names(self) -> SceneNames:
        """Collect everything that the spec names."""
        self.first_names = super().collect_names()
        return self.first_names

    def evaluate_parameter_block(self) -> Parameters:
        """Evaluate the parameters; they are recorded with the names that each of them uses."""
        self.given_parameters = self.get_block("parameters")
        self.evaluated_parameters = evaluate_parameters(self.given_parameters)
        return self.evaluated_parameters

    def make_scope(
        self, parameters: Mapping[str, float | None], given_parameters: Mapping[str, DimensionedParameter]
    ) -> Scope:
        """Make the scope of names that a constant number may use; the calculations are recorded."""
        return replace(super().make_scope(parameters, given_parameters), calculations=self.calculations)

    def make_reader(self, context: ReadContext) -> DocumentReader:
        """Make a reader that records what it reads."""
        self.contexts[context.time.in_time] = context
        points = WatchedMapping("points", context.points, self.log)
        return RecordingReader(
            self, ReadContext(self._watch_scope(context.load), self._watch_scope(context.time), points)
        )

    def _watch_scope(self, scope: Scope) -> Scope:
        """Return a copy of a scope that logs the lookups made in it."""
        names = ("parameters", "joints", "tables", "given", "points")
        return replace(scope, **{name: WatchedMapping(name, getattr(scope, name), self.log) for name in names})

    def build_entry_table(
        self, name: str, entry: f.TableEntry, scope: Scope
    ) -> tuple[TableFunction | None, list[TableProblem]]:
        """Build and record the table of an entry, and list what is wrong with it."""
        self.log.take()
        table, problems = super().build_entry_table(name, entry, self._watch_scope(scope))
        self.table_records[name] = TableRecord(table, entry, self.log.take(), problems)
        return table, problems

    def iter_violations(self, draft: DraftDocument) -> Iterator[tuple[Rule, Violation]]:
        """Yield the violations of the active rules, and record each rule's verdict with its lookups."""
        self.draft, self.watched_document = (
            draft,
            cast(f.Document, WatchedDocument("document", draft.document, self.log)),
        )
        unread = cast("frozenset[str]", WatchedMapping("unread", dict.fromkeys(draft.unread), self.log))
        entries, points, joints = (
            cast(
                "dict[str, Any]",
                WatchedMapping(f"names.{of}", getattr(draft.names, of), self.log, inner=of == "entries"),
            )
            for of in ("entries", "points", "joints")
        )
        for rule in self.active_rules:
            found, lookups = tuple(rule.check(draft)), None
            # each rule gets new names with an empty key cache, so that it logs every lookup it depends on
            watched_draft = DraftDocument(self.watched_document, SceneNames(entries, points, joints, {}), unread, {})
            self.log.take()
            with suppress(Exception):  # a rule that reads more than is watched is always applied again
                lookups = self.log.take() if tuple(rule.check(watched_draft)) == found else None
            self.verdict_records.append(VerdictRecord(found, lookups))
            yield from ((rule, violation) for violation in found)
        for path, target in draft.path_targets.items():
            self._record_path_target(path, target, SceneNames(entries, points, joints, {}))

    def _record_path_target(self, path: str, target: Any, names: SceneNames) -> None:
        """Record what a path into the results leads to."""
        from heuncli.scene.file_format.rules.outcome import find_path_target  # few specs have such paths

        self.log.take()
        with suppress(Exception):
            if is_same(find_path_target(DraftDocument(self.watched_document, names, frozenset(), {}), path), target):
                self.path_target_records[path] = MeaningRecord(target, self.log.take())

    def collect_locations(self) -> dict[str, SourceLocation]:
        """Collect the locations for later stages."""
        self.located_paths = self.list_located_paths()
        self.first_locations = super().collect_locations()
        return self.first_locations

    def find_changed_entries(self, changed_lookups: frozenset[Lookup]) -> list[tuple[str, Any]]:
        """Return the entries to read again after the changed lookups: block and name; of a single block, the block and
        None.
        """
        changed_entries = self.rereads.get(changed_lookups)
        if changed_entries is None:
            limit_cache(self.rereads)
            paths = [
                path for path, record in self.entry_records.items() if not record.lookups.isdisjoint(changed_lookups)
            ]
            found = [(str(path[0]), path[1] if len(path) > 1 else None) if path else ("head", None) for path in paths]
            changed_entries = self.rereads[changed_lookups] = [
                one for one in dict.fromkeys(found) if one[0] in f.Document._fields
            ]
        return changed_entries

    def find_unchanged_parts(self, differing: frozenset[Lookup]) -> UnchangedParts:
        """Return the parts of the scene whose meaning does not depend on the differing lookups."""
        unchanged = self.unchanged_parts.get(differing)
        if unchanged is None:
            limit_cache(self.unchanged_parts)
            parts = {key for key, record in self.meaning_records.items() if record.lookups.isdisjoint(differing)}
            names = {block: getattr(self.draft.document, block) for block in f.Document._fields}
            blocks = {
                block
                for block, entries in names.items()
                if isinstance(entries, dict) and all((block, name) in parts for name in entries)
            }
            unchanged = self.unchanged_parts[differing] = UnchangedParts(frozenset(parts), frozenset(blocks))
        return unchanged

    def plan_verdicts(self, differing: frozenset[Lookup]) -> VerdictPlan:
        """Return which of the rules' verdicts remain valid for the differing lookups."""
        plan = self.plans.get(differing)
        if plan is None:
            limit_cache(self.plans)
            verdicts = [
                (
                    rule,
                    record.violations if record.lookups is not None and record.lookups.isdisjoint(differing) else None,
                )
                for rule, record in zip(self.active_rules, self.verdict_records, strict=True)
            ]
            relevant = [(rule, found) for rule, found in verdicts if found is None or found]
            targets = {
                path: record.value
                for path, record in self.path_target_records.items()
                if record.lookups.isdisjoint(differing)
            }
            plan = self.plans[differing] = VerdictPlan(relevant, targets)
        return plan

    def find_paths_below(self, paths: frozenset[Path_]) -> list[Path_]:
        """Return the located paths at or below the given paths."""
        if paths not in self.paths_below:
            self.paths_below[paths] = [p for p in self.located_paths if any(p[: len(path)] == path for path in paths)]
        return self.paths_below[paths]


class RecordingReader(DocumentReader):
    """Records every entry that it reads."""

    def __init__(self, first: RecordingLoader, context: ReadContext) -> None:
        super().__init__(first.data, context, first.report)
        self.first = first

    def read_document(self) -> f.Document:
        """Read every block that can be read."""
        self.first.document = super().read_document()
        return self.first.document

    def read_model(self, path: Path_, data: Any, model: type[Entry]) -> Any:
        """Read and record one model."""
        self.first.log.take()
        entry = super().read_model(path, data, model)
        if entry is not None:
            self.first.entry_records[path] = EntryRecord(entry, data, self.first.log.take())
        return entry

    def read_shapes(self, path: Path_, body: f.BodyEntry) -> f.BodyEntry | None:
        """Return the body with its shapes read, and record both."""
        whole = super().read_shapes(path, body)
        if whole is not None:
            self.first.shaped_bodies[path] = body, whole
        return whole


class RecordingResolver(Resolver):
    """Resolves references, and records what each part of the scene depends on."""

    def __init__(self, first: RecordingLoader, document: f.Document, meaning: ResolveInputs) -> None:
        super().__init__(document, meaning.locations, meaning.curves, meaning.surfaces)
        self.first = first
        locations, curves, surfaces = (
            WatchedMapping(of, getattr(meaning, of), first.log) for of in ("locations", "curves", "surfaces")
        )
        self.watching_resolver = Resolver(first.watched_document, locations, curves, surfaces)

    def resolve_entries(self, block: str, method: str) -> dict[Any, Any]:
        """Resolve and record the entries of a block."""
        resolved = super().resolve_entries(block, method)
        for name, value in resolved.items():
            self._record((block, name), value, partial(self._resolve_watched, block, method, name))
        return resolved

    def _resolve_watched(self, block: str, method: str, name: Any) -> Any:
        """Resolve an entry once more with the resolver whose lookups are logged."""
        return getattr(self.watching_resolver, method)(name, getattr(self.first.watched_document, block)[name])

    def resolve_single(self, method: str) -> Any:
        """Resolve and record a part that belongs to the document as a whole."""
        value = super().resolve_single(method)
        self._record((method, None), value, lambda: self.watching_resolver.resolve_single(method))
        return value

    def _record(self, key: tuple[str, Any], value: Any, resolve_again: Callable[[], Any]) -> None:
        self.first.log.take()
        with suppress(Exception):
            if is_same(resolve_again(), value):
                self.first.meaning_records[key] = MeaningRecord(value, self.first.log.take())


def limit_cache(cache: dict[Any, Any]) -> None:
    """Empty a cache that is full; most variants differ in the same lookups, so few plans are needed."""
    if len(cache) == MAX_PLANS:
        cache.clear()
