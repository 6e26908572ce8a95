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

from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, cast

from heuncli.errors import SourceLocation, SpecError
from heuncli.expressions.calculations import Calculations
from heuncli.expressions.grammar import GivenParameter
from heuncli.expressions.programs import TableFunction
from heuncli.named_tuples import NamedTuple
from heuncli.nearest import begin_file
from heuncli.records import replace
from heuncli.spec import format as f
from heuncli.spec.document import Reader
from heuncli.spec.entries import Entry
from heuncli.spec.fields import Context
from heuncli.spec.load import Loading
from heuncli.spec.lookups import Log, Lookup, Watched, WatchedDocument, changed, changed_in_document
from heuncli.spec.models import Spec
from heuncli.spec.named_files import NamedFiles
from heuncli.spec.names import Names, mapping
from heuncli.spec.parameters import Parameters, evaluate_parameters
from heuncli.spec.quantity import Scope
from heuncli.spec.resolve import Meaning, Resolver, resolve
from heuncli.spec.rules.every import DraftDocument, Rule, Violation
from heuncli.spec.sharing import same, shared, shared_entries
from heuncli.spec.source import Path_, SourceFile, dotted, read
from heuncli.spec.tables import Wrong

WHOLE = ("title", "space", "gravity", "ground", "report", "foundation", "expect", "cases", "warnings")  # of a scene
MOST_PLANS = 1024  # of what is done again, by what differs


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


class KeptEntry(NamedTuple):
    """An entry, what it was read from, and what was looked up for it."""

    entry: Any
    data: Any
    lookups: frozenset[Lookup]


class KeptTable(NamedTuple):
    """A table, the entry it was built of, and what was looked up for it."""

    table: TableFunction | None
    entry: f.TableEntry
    lookups: frozenset[Lookup]


class KeptVerdict(NamedTuple):
    """What a rule found, and what it looked at; None: that is not known."""

    violations: tuple[Violation, ...]
    lookups: frozenset[Lookup] | None


class StandingParts(NamedTuple):
    """Parts of a scene that mean what they meant, by block and name; and the blocks of which all entries do."""

    parts: frozenset[tuple[str, Any]]
    blocks: frozenset[str]


class VerdictPlan(NamedTuple):
    """Rules with what they found, None where that may be something else; and what paths into the results lead to."""

    verdicts: list[tuple[Rule, tuple[Violation, ...] | None]]
    reached: dict[str, Any]


class KeptMeaning(NamedTuple):
    """What a part of the document means, and what of it was looked at."""

    value: Any
    lookups: frozenset[Lookup]


class FirstReading(Loading):
    """The reading that writes down what everything hangs on."""

    def __init__(
        self,
        path: str,
        source: SourceFile,
        overrides: Mapping[str, str],
        checking: bool,
        case: str | None,
        files: NamedFiles | None,
    ) -> None:
        super().__init__(path, source, overrides, checking, case, files)
        self.log = Log()
        self.entries: dict[Path_, KeptEntry] = {}
        self.document: f.Document
        self.with_shapes: dict[Path_, tuple[f.BodyEntry, f.BodyEntry]] = {}  # as read, and with its shapes
        self.built: dict[str, KeptTable] = {}
        self.contexts: dict[bool, Context] = {}  # by whether values in time may be read by it
        self.verdicts: list[KeptVerdict] = []
        self.calculations = Calculations()
        self.meanings: dict[tuple[str, Any], KeptMeaning] = {}
        self.reached: dict[str, KeptMeaning] = {}
        self.below: dict[frozenset[Path_], list[Path_]] = {}
        self.plans: dict[frozenset[Lookup], VerdictPlan] = {}
        self.meant_still: dict[frozenset[Lookup], StandingParts] = {}
        self.readings: dict[frozenset[Lookup], list[tuple[str, Any]]] = {}

    def spec(self) -> Spec:
        """The scene. Raises SpecError."""
        self.resolved = super().spec()
        return self.resolved

    def meant(self, document: f.Document, meaning: Meaning) -> Spec:
        """The scene that the document means, of which every part is kept."""
        self.curved = meaning.curves
        return resolve(document, meaning, FirstResolver(self, document, meaning))

    def names(self) -> Names:
        """What is named in the spec."""
        self.named = super().names()
        return self.named

    def evaluated(self) -> Parameters:
        """The parameters, which are kept with what each of them uses."""
        self.given_parameters = self.block("parameters")
        self.known = evaluate_parameters(self.given_parameters)
        return self.known

    def scope(self, parameters: Mapping[str, float | None], given: Mapping[str, GivenParameter]) -> Scope:
        """The names that a number may use that is read once; how it is calculated is kept."""
        return replace(super().scope(parameters, given), calculations=self.calculations)

    def reader(self, context: Context) -> Reader:
        """A reader that keeps what it reads."""
        self.contexts[context.time.in_time] = context
        points = Watched("points", context.points, self.log)
        return FirstReader(self, Context(self._watched(context.load), self._watched(context.time), points))

    def _watched(self, scope: Scope) -> Scope:
        """A scope that logs what is looked up in it."""
        names = ("parameters", "joints", "tables", "given", "points")
        return replace(scope, **{name: Watched(name, getattr(scope, name), self.log) for name in names})

    def table(self, name: str, entry: f.TableEntry, scope: Scope) -> tuple[TableFunction | None, list[Wrong]]:
        """The table of an entry, or what is wrong with it."""
        self.log.taken()
        table, wrong = super().table(name, entry, self._watched(scope))
        self.built[name] = KeptTable(table, entry, self.log.taken())
        return table, wrong

    def violations(self, draft: DraftDocument) -> Iterator[tuple[Rule, Violation]]:
        """What of the document breaks a rule."""
        self.draft, self.watched = draft, cast(f.Document, WatchedDocument("document", draft.document, self.log))
        unread = cast("frozenset[str]", Watched("unread", dict.fromkeys(draft.unread), self.log))
        entries, points, joints = (
            cast("dict[str, Any]", Watched(f"names.{of}", getattr(draft.names, of), self.log, inner=of == "entries"))
            for of in ("entries", "points", "joints")
        )
        for rule in self.rules:
            found, lookups = tuple(rule.check(draft)), None
            # what the names gather as they are asked is gathered for each rule: each looks up all that it hangs on
            looking = DraftDocument(self.watched, Names(entries, points, joints, {}), unread, {})
            self.log.taken()
            with suppress(Exception):  # a rule that asks for more than is watched is not kept
                lookups = self.log.taken() if tuple(rule.check(looking)) == found else None
            self.verdicts.append(KeptVerdict(found, lookups))
            yield from ((rule, violation) for violation in found)
        for path, reached in draft.reached.items():
            self._keep_reached(path, reached, Names(entries, points, joints, {}))

    def _keep_reached(self, path: str, reached: Any, names: Names) -> None:
        """Keep what a path into the results leads to."""
        from heuncli.spec.rules.outcome import reached_in  # few specs have such paths

        self.log.taken()
        with suppress(Exception):
            if same(reached_in(DraftDocument(self.watched, names, frozenset(), {}), path), reached):
                self.reached[path] = KeptMeaning(reached, self.log.taken())

    def locations(self) -> dict[str, SourceLocation]:
        """Locations for later stages."""
        self.placed = self.places()
        self.located = super().locations()
        return self.located

    def fallen(self, changed: frozenset[Lookup]) -> list[tuple[str, Any]]:
        """Where lookups give something else: what is to be read again, by block and name; of a single block by it."""
        planned = self.readings.get(changed)
        if planned is None:
            forget_many(self.readings)
            paths = [path for path, kept in self.entries.items() if not kept.lookups.isdisjoint(changed)]
            found = [(str(path[0]), path[1] if len(path) > 1 else None) if path else ("head", None) for path in paths]
            planned = self.readings[changed] = [one for one in dict.fromkeys(found) if one[0] in f.Document._fields]
        return planned

    def standing(self, differing: frozenset[Lookup]) -> StandingParts:
        """Which parts of the scene mean what they meant where something differs."""
        found = self.meant_still.get(differing)
        if found is None:
            forget_many(self.meant_still)
            parts = {key for key, kept in self.meanings.items() if kept.lookups.isdisjoint(differing)}
            names = {block: getattr(self.draft.document, block) for block in f.Document._fields}
            blocks = {
                block
                for block, entries in names.items()
                if isinstance(entries, dict) and all((block, name) in parts for name in entries)
            }
            found = self.meant_still[differing] = StandingParts(frozenset(parts), frozenset(blocks))
        return found

    def plan(self, differing: frozenset[Lookup]) -> VerdictPlan:
        """What stands of the rules' verdicts where something differs."""
        planned = self.plans.get(differing)
        if planned is None:
            forget_many(self.plans)
            plan = [
                (rule, kept.violations if kept.lookups is not None and kept.lookups.isdisjoint(differing) else None)
                for rule, kept in zip(self.rules, self.verdicts, strict=True)
            ]
            told = [(rule, found) for rule, found in plan if found is None or found]
            reached = {path: kept.value for path, kept in self.reached.items() if kept.lookups.isdisjoint(differing)}
            planned = self.plans[differing] = VerdictPlan(told, reached)
        return planned

    def places_in(self, paths: frozenset[Path_]) -> list[Path_]:
        """The places that stand at or below some paths."""
        if paths not in self.below:
            self.below[paths] = [p for p in self.placed if any(p[: len(each)] == each for each in paths)]
        return self.below[paths]


class FirstReader(Reader):
    """Keeps every entry that it reads."""

    def __init__(self, first: FirstReading, context: Context) -> None:
        super().__init__(first.data, context, first.report)
        self.first = first

    def document(self) -> f.Document:
        """All that can be read."""
        self.first.document = super().document()
        return self.first.document

    def model(self, path: Path_, data: Any, model: type[Entry]) -> Any:
        """One model."""
        self.first.log.taken()
        entry = super().model(path, data, model)
        if entry is not None:
            self.first.entries[path] = KeptEntry(entry, data, self.first.log.taken())
        return entry

    def with_shapes(self, path: Path_, body: f.BodyEntry) -> f.BodyEntry | None:
        """A body with its shapes read."""
        whole = super().with_shapes(path, body)
        if whole is not None:
            self.first.with_shapes[path] = body, whole
        return whole


class FirstResolver(Resolver):
    """Follows references, and keeps what each part of the scene hangs on."""

    def __init__(self, first: FirstReading, document: f.Document, meaning: Meaning) -> None:
        super().__init__(document, meaning.locations, meaning.curves)
        self.first = first
        locations, curves = (Watched(of, getattr(meaning, of), first.log) for of in ("locations", "curves"))
        self.looking = Resolver(first.watched, locations, curves)

    def entries(self, block: str, by: str) -> dict[Any, Any]:
        """What the entries of a block mean."""
        meant = super().entries(block, by)
        for name, value in meant.items():
            self._keep((block, name), value, partial(self._again, block, by, name))
        return meant

    def _again(self, block: str, by: str, name: Any) -> Any:
        """What an entry means, by one that looks at it."""
        return getattr(self.looking, by)(name, getattr(self.first.watched, block)[name])

    def single(self, by: str) -> Any:
        """What the document as a whole means."""
        value = super().single(by)
        self._keep((by, None), value, lambda: self.looking.single(by))
        return value

    def _keep(self, key: tuple[str, Any], value: Any, again: Callable[[], Any]) -> None:
        self.first.log.taken()
        with suppress(Exception):
            if same(again(), value):
                self.first.meanings[key] = KeptMeaning(value, self.first.log.taken())


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
                return kept.table, []
        return super().table(name, entry, scope)

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
        super().__init__(document, meaning.locations, meaning.curves)
        first = later.first
        self.kept, self.before, self.drafted = first.meanings, first.resolved, first.draft.document
        curves = changed("curves", meaning.curves, first.curved)
        moved = (Lookup("locations", words) for words in later.moved)
        self.standing = first.standing(later.differing.union(moved, curves))

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


def forget_many(kept: dict[Any, Any]) -> None:
    """Forget what is kept where there is too much of it: most variants differ in the same."""
    if len(kept) == MOST_PLANS:
        kept.clear()


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
