"""The reading of a spec that writes down what everything hangs on (variants.py), and what is kept of it.

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
from heuncli.scene.expressions.calculations import Calculations
from heuncli.scene.expressions.grammar import GivenParameter
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.document import Reader
from heuncli.scene.file_format.entries import Entry
from heuncli.scene.file_format.fields import Context
from heuncli.scene.file_format.load import Loading
from heuncli.scene.file_format.lookups import Log, Lookup, Watched, WatchedDocument
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.names import Names
from heuncli.scene.file_format.parameters import Parameters, evaluate_parameters
from heuncli.scene.file_format.quantity import Scope
from heuncli.scene.file_format.resolve import Meaning, Resolver, resolve
from heuncli.scene.file_format.rules.every import DraftDocument, Rule, Violation
from heuncli.scene.file_format.sharing import same
from heuncli.scene.file_format.source import Path_, SourceFile
from heuncli.scene.file_format.tables import Wrong

MOST_PLANS = 1024  # of what is done again, by what differs


class KeptEntry(NamedTuple):
    """An entry, what it was read from, and what was looked up for it."""

    entry: Any
    data: Any
    lookups: frozenset[Lookup]


class KeptTable(NamedTuple):
    """A table, the entry it was built of, what was looked up for it, and the findings that were made with it."""

    table: TableFunction | None
    entry: f.TableEntry
    lookups: frozenset[Lookup]
    findings: list[Wrong]


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
        self.curved, self.surfaced = meaning.curves, meaning.surfaces
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
        self.built[name] = KeptTable(table, entry, self.log.taken(), wrong)
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
        from heuncli.scene.file_format.rules.outcome import reached_in  # few specs have such paths

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
        super().__init__(document, meaning.locations, meaning.curves, meaning.surfaces)
        self.first = first
        locations, curves, surfaces = (
            Watched(of, getattr(meaning, of), first.log) for of in ("locations", "curves", "surfaces")
        )
        self.looking = Resolver(first.watched, locations, curves, surfaces)

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


def forget_many(kept: dict[Any, Any]) -> None:
    """Forget what is kept where there is too much of it: most variants differ in the same."""
    if len(kept) == MOST_PLANS:
        kept.clear()
