"""The reading of a spec with other values, which takes from the first one (first_reading.py) what stands (variants.py).

Impure: reads the tables that have changed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from heuncli.base.errors import SourceLocation
from heuncli.base.records import replace
from heuncli.scene.expressions.grammar import GivenParameter
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.document import Reader
from heuncli.scene.file_format.entries import Entry
from heuncli.scene.file_format.fields import Context
from heuncli.scene.file_format.first_reading import FirstReading
from heuncli.scene.file_format.load import Loading
from heuncli.scene.file_format.lookups import Lookup, changed, changed_in_document
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import Names, mapping
from heuncli.scene.file_format.parameters import Parameters, evaluate_parameters
from heuncli.scene.file_format.quantity import Scope
from heuncli.scene.file_format.resolve import Meaning, Resolver, resolve
from heuncli.scene.file_format.rules.every import DraftDocument, Rule, Violation
from heuncli.scene.file_format.sharing import same, shared, shared_entries
from heuncli.scene.file_format.source import Path_, dotted
from heuncli.scene.file_format.tables import Wrong

if TYPE_CHECKING:
    from heuncli.scene.meshes.model import TriangleMesh

WHOLE = ("title", "space", "gravity", "ground", "report", "foundation", "expect", "cases", "warnings")  # of a scene


class LaterReading(Loading):
    """A reading with other values, which takes from the first one what stands."""

    def __init__(self, first: FirstReading, overrides: Mapping[str, str]) -> None:
        self.first = first
        super().__init__(first.path, first.source, overrides, first.checking, first.case, first.files)

    def completed(self, given: dict[str, Any]) -> dict[str, Any]:
        """The data as they are read, with the blocks and entries of the first reading where they are the same."""
        before, set_ = self.first.data, {path[0] for path in (*self.set, *self.first.set)}
        self.by_parameters = set_ <= {"parameters"}
        if self.by_parameters:  # which stand in the data as they are written
            return {**before, **{block: value for block, value in given.items() if block in set_}}
        return _shared_data(super().completed(given), before)

    def meant(self, document: f.Document, meaning: Meaning) -> Spec:
        """The scene that the document means, with the values of the first one where they are the same."""
        before = self.first.resolved
        made = resolve(document, meaning, LaterResolver(self, document, meaning))
        others = {name: shared(getattr(made, name), getattr(before, name)) for name in WHOLE}
        tables = shared_entries(made.tables, before.tables)
        return made._replace(tables=tables, parameters=shared_entries(made.parameters, before.parameters), **others)

    def names(self) -> Names:
        """What is named in the spec: where parameters alone are others that of the first reading, but for these."""
        if not self.by_parameters:
            return super().names()
        known = self.first.named
        entries = {**known.entries, "parameters": mapping(self.data.get("parameters"))}
        return Names(entries, known.points, known.joints, {})

    def evaluated(self) -> Parameters:
        """The parameters."""
        given = self.block("parameters")
        return evaluate_parameters(given, _unchanged(given, self.first.given_parameters, self.first.known))

    def scope(self, parameters: Mapping[str, float | None], given: Mapping[str, GivenParameter]) -> Scope:
        """The names that a number may use; where they are those of the first reading, what that has read is known."""
        same_names = self.by_parameters and parameters.keys() == self.first.known.values.keys()
        calculations = self.first.calculations if same_names else None
        return replace(super().scope(parameters, given), calculations=calculations)

    def reader(self, context: Context) -> Reader:
        """A reader that takes entries from the first reading."""
        return LaterReader(self, context, frozenset(self._changed(context)))

    def _changed(self, context: Context) -> Iterator[Lookup]:
        """What lookups while entries or tables are read do not give now what they gave."""
        before = self.first.contexts[context.time.in_time]
        for name in ("parameters", "given", "joints", "tables"):
            new, old = (getattr(one.time, name) for one in (context, before))
            yield from changed(name, shared_entries(new, old), old)
        yield from changed("points", shared_entries(context.points, before.points), before.points)

    def table(self, name: str, entry: f.TableEntry, scope: Scope) -> tuple[TableFunction | None, list[Wrong]]:
        """The table of an entry, or what is wrong with it."""
        kept = self.first.built.get(name)
        if kept is not None and kept.entry is entry:
            differing = frozenset(self._changed(Context(scope, scope)))
            if kept.lookups.isdisjoint(differing):
                return kept.table, kept.findings
        return super().table(name, entry, scope)

    def surface(self, file: str) -> tuple[TriangleMesh | None, list[Wrong]]:
        """The mesh in a file, which is read once for all variants."""
        kept = self.first.surfaced.get(file)
        return (kept, []) if kept is not None else super().surface(file)

    def violations(self, draft: DraftDocument) -> Iterator[tuple[Rule, Violation]]:
        """What of the document breaks a rule."""
        self.differing = frozenset(self._differing(draft))
        plan = self.first.plan(self.differing)
        draft.reached.update(plan.reached)
        for rule, kept in plan.verdicts:
            found = rule.check(draft) if kept is None else kept
            yield from ((rule, violation) for violation in found)

    def _differing(self, draft: DraftDocument) -> Iterator[Lookup]:
        """What rules would not see as they saw it."""
        before = self.first.draft
        yield from changed("unread", dict.fromkeys(draft.unread), dict.fromkeys(before.unread))
        for name in ("points", "joints"):
            new, old = getattr(draft.names, name), getattr(before.names, name)
            yield from changed(f"names.{name}", shared_entries(new, old), old)
        for block, entries in draft.names.entries.items():
            yield from changed(f"names.entries.{block}", entries, before.names.entries[block])
        yield from changed_in_document("document", draft.document, before.document)

    def locations(self) -> dict[str, SourceLocation]:
        """Locations for later stages: of the first reading, but for those on the command line of either."""
        set_ = frozenset({*self.set, *self.first.set})
        moved = self.locations_of((*self.first.places_in(set_), *self.set))
        gone = {dotted(path) for path in self.first.set}
        self.moved = moved.keys() | gone
        if not gone:
            return {**self.first.located, **moved}
        return {words: place for words, place in self.first.located.items() if words not in gone} | moved


class LaterResolver(Resolver):
    """Follows references where something that a part of the scene hangs on has changed."""

    def __init__(self, later: LaterReading, document: f.Document, meaning: Meaning) -> None:
        super().__init__(document, meaning.locations, meaning.curves, meaning.surfaces)
        first = later.first
        self.kept, self.before, self.drafted = first.meanings, first.resolved, first.draft.document
        curves = changed("curves", meaning.curves, first.curved)
        surfaces = changed("surfaces", meaning.surfaces, first.surfaced)
        moved = (Lookup("locations", words) for words in later.moved)
        self.standing = first.standing(later.differing.union(moved, curves, surfaces))

    def entries(self, block: str, by: str) -> dict[Any, Any]:
        """What the entries of a block mean; of a block in which all stand the first one."""
        made, entries, before = getattr(self, by), getattr(self.document, block), getattr(self.before, block)
        if type(before) is dict and entries is getattr(self.drafted, block) and block in self.standing.blocks:
            return before
        found = {name: self._of((block, name), partial(made, name, entry)) for name, entry in entries.items()}
        unchanged = type(before) is dict and _is_as_before(found, before)
        return before if unchanged else found

    def single(self, by: str) -> Any:
        """What the document as a whole means."""
        return self._of((by, None), getattr(self, by))

    def _of(self, key: tuple[str, Any], made: Callable[[], Any]) -> Any:
        kept = self.kept.get(key)
        if kept is None:
            return made()
        return kept.value if key in self.standing.parts else shared(made(), kept.value)


class LaterReader(Reader):
    """Takes entries from the first reading where nothing that they hang on has changed."""

    def __init__(self, later: LaterReading, context: Context, changed: frozenset[Lookup]) -> None:
        super().__init__(later.data, context, later.report)
        self.first, self.changed, self.by_parameters = later.first, changed, later.by_parameters

    def document(self) -> f.Document:
        """All that can be read: where parameters alone are others, what hangs on those that have changed."""
        if not self.by_parameters:
            return super().document()
        anew: dict[str, Any] = {}
        for block, name in self.first.fallen(self.changed):
            if block in f.SINGLE:
                anew[block] = self.single(block, f.SINGLE[block])
            elif block == "head":
                anew[block] = self.head()
            else:
                entries = anew.setdefault(block, {**getattr(self.first.document, block)})
                entries[name] = self._again(block, name)
                if entries[name] is None:
                    del entries[name]
        return self.first.document._replace(**anew)

    def _again(self, block: str, name: Any) -> Any:
        """An entry that the first reading has read."""
        data = self.data[block][name]
        if block == "expect":
            return self.model((block, name), data, f.ExpectEntry)
        return self.entry(block, name, data, f.ENTRIES[block])

    def model(self, path: Path_, data: Any, model: type[Entry]) -> Any:
        """One model."""
        kept = self.first.entries.get(path)
        stands = kept is not None and type(kept.entry) is model and same(data, kept.data)
        if kept is not None and stands and kept.lookups.isdisjoint(self.changed):
            return kept.entry
        return super().model(path, data, model)

    def with_shapes(self, path: Path_, body: f.BodyEntry) -> f.BodyEntry | None:
        """A body with its shapes read."""
        read, whole = self.first.with_shapes.get(path, (None, None))
        new = super().with_shapes(path, body)
        if new is None or whole is None or body is not read or not _is_as_before(new.shapes, whole.shapes):
            return new
        return whole


def _unchanged(given: dict[str, Any], before: dict[str, Any], evaluated: Parameters) -> Parameters:
    """Of parameters that were evaluated before those whose values stand: they and what they use are as they were."""
    standing = {name for name in given if name in before and same(given[name], before[name])}
    standing = standing if given.keys() == before.keys() else set()
    while fallen := {name for name in standing if not evaluated.uses[name] & before.keys() <= standing}:
        standing -= fallen
    return Parameters(
        {name: value for name, value in evaluated.values.items() if name in standing},
        {name: value for name, value in evaluated.given.items() if name in standing},
        [],
        {name: value for name, value in evaluated.uses.items() if name in standing},
    )


def _is_as_before(new: Any, old: Any) -> bool:
    """Whether an entry is the same object, or all entries of a block or list are."""
    if isinstance(new, dict) and isinstance(old, dict):
        return [*new] == [*old] and all(new[key] is old[key] for key in new)
    if isinstance(new, list) and isinstance(old, list):
        return len(new) == len(old) and all(a is b for a, b in zip(new, old, strict=True))
    return new is old


def _shared_data(new: dict[str, Any], old: dict[str, Any]) -> dict[str, Any]:
    """Data with the blocks and entries of older data where they are the same."""
    return {
        block: shared_entries(value, old[block]) if type(value) is dict and type(old.get(block)) is dict
        else shared(value, old.get(block))
        for block, value in new.items()
    }  # fmt: skip
