"""A file -> Spec, or every error in it at once. Impure: reads the spec's file and those of its tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from heuncli.base.errors import Problem, SourceLocation, SpecError
from heuncli.base.nearest import begin_file, did_you_mean
from heuncli.base.records import replace
from heuncli.scene.expressions.grammar import GivenParameter
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.cases import CASES, faults, settings_of
from heuncli.scene.file_format.document import Reader
from heuncli.scene.file_format.fields import Context
from heuncli.scene.file_format.format_shapes import MeshShape
from heuncli.scene.file_format.models import Curve, Spec
from heuncli.scene.file_format.names import NAMED, Names, mapping
from heuncli.scene.file_format.overrides import Setting, of_words, override, taken_in_si
from heuncli.scene.file_format.parameters import Parameters, evaluate_parameters
from heuncli.scene.file_format.planar import in_the_plane
from heuncli.scene.file_format.quantity import Scope, kind_of
from heuncli.scene.file_format.resolve import Meaning, resolve
from heuncli.scene.file_format.rules.every import RULES, DraftDocument, Rule, Violation, violations
from heuncli.scene.file_format.semantics import instants_of
from heuncli.scene.file_format.source import Path_, SourceFile, dotted, read
from heuncli.scene.file_format.verdicts import is_primary

if TYPE_CHECKING:
    from pathlib import Path

    from heuncli.scene.file_format.named_files import NamedFiles
    from heuncli.scene.file_format.tables import Wrong
    from heuncli.scene.meshes.model import TriangleMesh

HOW_IMPORTED = "heun import makes a spec of a robot in URDF, or a model of MuJoCo's"
PLACED = ("analysis", "couplings", "drives", "expect", "forces")  # blocks of which later stages can locate every value


Given = Mapping[str, str] | Sequence[Setting]


def load(
    path: str | Path,
    text: str | SourceFile | None = None,
    overrides: Given | None = None,
    checking: bool = True,
    case: str | None = None,
) -> Spec:
    """The scene in a file ("-" is standard input), or in what stands for it: a text, or what was read already.

    overrides are parameters or dotted keys with their new values, as text or as they are; case: a load case, whose
    values they go on top of. Files of tables are looked for beside the spec, for standard input in the working
    directory. Without `checking` expectations need not fit the instants asked for, which may have been overridden.
    Raises SpecError with all problems, in the order of the lines.
    """
    path = str(path)
    begin_file()
    return Loading(path, _source(path, text), overrides or {}, checking, case).spec()


def _source(path: str, text: str | SourceFile | None) -> SourceFile:
    return text if isinstance(text, SourceFile) else read(path, text)


def load_with_cases(
    path: str,
    overrides: Given | None = None,
    checking: bool = True,
    text: str | SourceFile | None = None,
    files: NamedFiles | None = None,
) -> tuple[Spec, dict[str, Spec]]:
    """The scene, and each of its load cases by its name, of one reading of the file, or of a text that stands for it.

    files: those that the spec names; None: they stand beside it.

    Raises SpecError with all problems of the scene, else with those of all cases, which are named in them.
    """
    begin_file()
    source = _source(path, text)
    spec = Loading(path, source, overrides or {}, checking, None, files).spec()
    cases: dict[str, Spec] = {}
    problems: list[Problem] = []
    for name in spec.cases:
        try:
            cases[name] = Loading(path, source, overrides or {}, checking, name, files).spec()
        except SpecError as error:
            problems += [each._replace(message=f"in case {name}: {each.message}") for each in error.problems]
    if problems:
        raise SpecError(*problems)
    return spec, cases


class Loading:
    """One spec on its way; gathers problems as it goes."""

    def __init__(
        self,
        path: str,
        source: SourceFile,
        overrides: Given,
        checking: bool,
        case: str | None,
        files: NamedFiles | None = None,
    ) -> None:
        """files: those that the spec names; None: they stand beside it."""
        self.path, self.source, self.checking, self.case, self.files = path, source, checking, case, files
        self.problems = list(source.problems)
        self.warnings: list[Problem] = []
        self.unread: set[str] = set()
        if type(source.data) is not dict:
            kind = kind_of(source.data) if type(source.data) is not str else "a text"  # of whatever file: not told
            message = f"a spec is a mapping, this is {kind}"
            is_xml = type(source.data) is str and source.data.startswith("<")
            hint = HOW_IMPORTED if is_xml else "it starts with 'heun: 1'"
            raise SpecError(*self.problems, Problem("not-a-scene", message, source.location(()), hint))
        without_empty = {k: {} if v is None and k in (*NAMED, "ground") else v for k, v in source.data.items()}
        settings, problems = of_words(overrides) if isinstance(overrides, Mapping) else ([*overrides], [])
        settings = [*(settings_of(case, source) if case is not None else ()), *settings]
        given, self.set, unset = override(without_empty, settings)
        self.warnings += taken_in_si(without_empty, given, self.set) if self.set else ()
        problems += unset
        problems += faults(without_empty, source) if CASES in source.data else ()
        self.data = self.completed(given)
        self.problems += problems

    @property
    def rules(self) -> list[Rule]:
        """The rules that are asked."""
        return [rule for rule in RULES if self.checking or not rule.for_check]

    def completed(self, given: dict[str, Any]) -> dict[str, Any]:
        """The data as they are read: those of a planar scene as of one in space."""
        return in_the_plane(given) if given.get("space") == "planar" else given

    def location(self, path: Path_, key: bool = False) -> SourceLocation:
        """Where the value of a path stands: in the file, or on the command line."""
        for depth in range(len(path), 0, -1):
            given = self.set.get(path[:depth])
            if given is not None:
                return SourceLocation(given.file, given.line, given.column, dotted(path))
        made = [location for given, location in self.set.items() if given[: len(path)] == path]
        if made and path not in self.source.values:  # a key that exists only because a key below it was set
            return SourceLocation(made[0].file, made[0].line, made[0].column, dotted(path))
        return self.source.location(path, key)

    def report(self, code: str, violation: Violation) -> None:
        """Add an error in what is read, unless it is the consequence of another."""
        self.unread.update(map(str, violation.path[:1]))
        if is_primary(code):
            self.problems.append(
                Problem(code, violation.message, self.location(violation.path, violation.key), violation.hint)
            )

    def spec(self) -> Spec:
        """The scene. Raises SpecError."""
        parameters, given = self.parameters()
        names = self.names()
        scope = self.scope(parameters, given)
        tables = self.tables(scope)
        in_time = replace(scope, joints=names.joints, tables=tables, in_time=True, points=names.points)
        context = Context(scope, in_time, names.points)
        reader = self.reader(context)
        document = reader.document()
        expected = dict(self.expected(document))
        draft = DraftDocument(document._replace(expect=expected), names, frozenset(self.unread), {})
        self.judge(draft, reader.follows)
        curves, surfaces = self.curves(draft), self.surfaces(document)
        if self.problems:
            raise SpecError(*in_order(self.problems))
        values = {name: value for name, value in parameters.items() if value is not None}
        built = {name: table for name, table in tables.items() if table is not None}
        warnings = tuple(in_order(self.warnings))
        source = self.source
        places = self.locations()
        meaning = Meaning(source.file, source.sha256, values, built, warnings, places, curves, surfaces, self.case)
        return self.meant(draft.document, meaning)

    def scope(self, parameters: Mapping[str, float | None], given: Mapping[str, GivenParameter]) -> Scope:
        """The names that a number may use that is read once."""
        return Scope(parameters, given=given)

    def meant(self, document: f.Document, meaning: Meaning) -> Spec:
        """The scene that the document means."""
        return resolve(document, meaning)

    def reader(self, context: Context) -> Reader:
        """What reads the entries, whose values may refer to the context."""
        return Reader(self.data, context, self.report)

    def violations(self, draft: DraftDocument) -> Iterator[tuple[Rule, Violation]]:
        """What of the document breaks a rule."""
        return violations(self.rules, draft)

    def names(self) -> Names:
        """What is named in the spec."""
        return Names.of(self.data)

    def evaluated(self) -> Parameters:
        """The parameters of the spec."""
        return evaluate_parameters(self.block("parameters"))

    def table(self, name: str, entry: f.TableEntry, scope: Scope) -> tuple[TableFunction | None, list[Wrong]]:
        """The table of an entry, or what is wrong with it."""
        from heuncli.scene.file_format.tables import build_table  # with csv 2 ms that few scenes need

        return build_table(name, entry, scope, self.named_files())

    def parameters(self) -> tuple[dict[str, float | None], dict[str, GivenParameter]]:
        """Values of the parameters, None for those in error; and those that have a dimension."""
        parameters = self.evaluated()
        for name, finding in parameters.findings:
            self.report(finding.code, Violation(("parameters", name), finding.message, finding.hint))
        return parameters.values, parameters.given

    def tables(self, scope: Scope) -> dict[str, TableFunction | None]:
        """The tables; None for those in error."""
        entries = self.block("tables")
        if not entries:
            return {}
        reader = self.reader(Context(scope, scope))
        tables: dict[str, TableFunction | None] = {}
        for name, data in entries.items():
            path = ("tables", name)
            entry = reader.model(path, data, f.TableEntry)
            tables[name], wrong = self.table(name, entry, scope) if entry is not None else (None, [])
            if entry is not None and entry.file is not None and (told := self.named_files().outside(entry.file)):
                self.warnings.append(Problem(told.code, told.message, self.location((*path, "file")), told.hint))
            self.report_read(path, wrong)
        return tables

    def curves(self, draft: DraftDocument) -> dict[int, Curve]:
        """The curves of expectations, by their places in the list; those in error are left out."""
        asked = {i: item for i, item in draft.document.expect.items() if item.curve is not None}
        if not asked:
            return {}
        from heuncli.base.units import TIME
        from heuncli.scene.file_format.measured import build_curve  # as for tables
        from heuncli.scene.file_format.rules.curves import abscissa
        from heuncli.scene.file_format.rules.expect import outcomes

        instants = instants_of(draft.document) if self.checking else ()
        run = (min(instants), max(instants)) if len(instants) > 1 else None
        curves: dict[int, Curve] = {}
        kinds = {path[1]: quantity for path, _, quantity in outcomes(draft)}
        for i, item in asked.items():
            path = ("expect", i)
            across, quantity = abscissa(item, draft), kinds.get(i)
            known = (
                (TIME,) if across is None else across.dimensions,
                () if quantity is None else quantity.dimensions,
            )
            x_of = None if across is None else str(item.x)
            curve, wrong = build_curve(item, x_of, run, known, self.named_files())
            if curve is not None:
                curves[i] = curve
            if told := self.named_files().outside(str(item.curve)):
                self.warnings.append(Problem(told.code, told.message, self.location((*path, "curve")), told.hint))
            self.report_read(path, wrong)
        return curves

    def surfaces(self, document: f.Document) -> dict[str, TriangleMesh]:
        """The meshes of shapes, by the names of their files; those in error are left out."""
        shapes = [
            (("bodies", name, "shapes", i), shape)
            for name, body in document.bodies.items()
            for i, shape in enumerate(body.shapes or ())
            if isinstance(shape, MeshShape)
        ]
        found: dict[str, tuple[TriangleMesh | None, list[Wrong]]] = {}
        for path, shape in shapes:
            from heuncli.scene.file_format.surfaces import judged, noted  # few scenes have them

            if shape.file not in found:
                found[shape.file] = self.surface(shape.file)
            surface, wrong = found[shape.file]
            self.report_read(path, wrong if surface is None else [*judged(shape, surface)])
            for told in noted(shape, surface, self.named_files()):
                self.warnings.append(Problem(told.code, told.message, self.location((*path, "file")), told.hint))
        return {file: surface for file, (surface, _) in found.items() if surface is not None}

    def surface(self, file: str) -> tuple[TriangleMesh | None, list[Wrong]]:
        """The mesh in a file, or what is wrong with it."""
        from heuncli.scene.file_format.surfaces import surface_of  # few scenes have them

        return surface_of(file, self.named_files())

    def named_files(self) -> NamedFiles:
        """The files that the spec names."""
        if self.files is None:
            from heuncli.scene.file_format.named_files import NamedFiles  # with pathlib 3 ms that few scenes need

            self.files = NamedFiles(self.path)
        return self.files

    def report_read(self, path: Path_, wrong: Sequence[Wrong]) -> None:
        """Add what is wrong with an entry that names a file: at its keys, or in the file."""
        for item in wrong:
            finding = item.finding
            if item.location is not None:
                problem = Problem(finding.code, finding.message, item.location, finding.hint)
                (self.warnings if item.is_warning else self.problems).append(problem)
            else:
                self.report(finding.code, Violation((*path, *item.keys), finding.message, finding.hint))

    def expected(self, document: f.Document) -> Iterator[tuple[int, f.ExpectEntry]]:
        """What is expected in the case at hand, by its place in the list; cases that are none are reported."""
        known = mapping(self.data.get(CASES))
        for i, item in document.expect.items():
            if item.case is not None and item.case not in known:
                hint = did_you_mean(item.case, known, "cases") if known else "cases: {NAME: {set: {...}}}"
                violation = Violation(("expect", i, "case"), f"there is no load case '{item.case}'", hint)
                self.report("unknown-case", violation)
            elif item.case is None or item.case == self.case:
                yield i, item

    def block(self, name: str) -> dict[str, Any]:
        """A block of named values; empty where it is none."""
        value = self.data.get(name, {})
        if type(value) is not dict:
            self.report(
                "wrong-kind", Violation((name,), f"expected a mapping, found {kind_of(value)}", "its keys are names")
            )
        return mapping(value)

    def judge(self, draft: DraftDocument, follows: Callable[[Path_], bool]) -> None:
        """Apply the rules; what may be the consequence of another error is not reported."""
        for rule, violation in self.violations(draft):
            if rule.follows and follows(violation.path):
                continue
            problem = Problem(
                rule.code, violation.message, self.location(violation.path, violation.key), violation.hint
            )
            (self.warnings if rule.is_warning else self.problems).append(problem)

    def locations(self) -> dict[str, SourceLocation]:
        """Locations for later stages: of every entry, and of every value that may fail during the run."""
        return self.locations_of((*self.places(), *self.set))

    def places(self) -> list[Path_]:
        """The paths of the file of which later stages may ask for the location."""
        values = self.source.values
        return [path for path in values if 0 < len(path) <= 2 or (path and path[0] in PLACED)]

    def locations_of(self, paths: Iterable[Path_]) -> dict[str, SourceLocation]:
        """The locations of some paths, by the words that users write for them."""
        return {dotted(path): self.location(path, key=len(path) <= 2) for path in paths}


def in_order(problems: list[Problem]) -> list[Problem]:
    """By file, line and column; each once."""
    locations = [p.location or SourceLocation("", 0, 0) for p in problems]
    order = sorted(range(len(problems)), key=lambda i: (locations[i].file, locations[i].line, locations[i].column))
    return list(dict.fromkeys(problems[i] for i in order))
