"""Load a file into a Spec, or report every error in it at once. Impure: reads the spec's file and those of its
tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.records import replace
from heuncli.base.spelling import reset_effort, suggest
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.expressions.scope import DimensionedParameter
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.document import DocumentReader
from heuncli.scene.file_format.fields import ReadContext
from heuncli.scene.file_format.foreign_words import replace_type_aliases
from heuncli.scene.file_format.format_shapes import MeshShape
from heuncli.scene.file_format.labels import LabelSplitter, replace_changed
from heuncli.scene.file_format.models import Curve, Logo, Spec
from heuncli.scene.file_format.names import NAMED_BLOCKS, SceneNames, as_mapping, complete_planar_scene
from heuncli.scene.file_format.parameters import (
    CASES,
    Parameters,
    Setting,
    apply_settings,
    evaluate_parameters,
    iter_case_problems,
    iter_si_warnings,
    list_case_settings,
    parse_settings,
)
from heuncli.scene.file_format.pydantic_errors import is_primary
from heuncli.scene.file_format.quantity import ParameterValue, Scope, describe_kind
from heuncli.scene.file_format.resolve import ResolveInputs, resolve
from heuncli.scene.file_format.rules.every import RULES, DraftDocument, Rule, Violation, iter_violations
from heuncli.scene.file_format.semantics import list_instants
from heuncli.scene.file_format.source import Path_, SourceFile, format_path, read_source

if TYPE_CHECKING:
    from pathlib import Path

    from heuncli.scene.file_format.named_files import NamedFiles
    from heuncli.scene.file_format.tables import TableProblem
    from heuncli.scene.meshes.model import TriangleMesh

IMPORT_HINT = "heun import converts a URDF robot or a MuJoCo model to a spec"
LOCATED_BLOCKS = (
    "analysis",
    "couplings",
    "drives",
    "expect",
    "forces",
)  # blocks in which later stages can locate every value


Overrides = Mapping[str, ParameterValue] | Sequence[Setting]


def load(
    path: str | Path,
    text: str | SourceFile | None = None,
    overrides: Overrides | None = None,
    checking: bool = True,
    case: str | None = None,
) -> Spec:
    """Load the scene of a file ("-" is standard input), of a text, or of a source that was read already.

    overrides: parameters or dotted keys with new values, as text or as values; they are applied after those of the load
    case
    checking: whether expectations must fit the output instants, which may have been overridden
    case: the load case to apply

    Table files are looked up next to the spec; for standard input in the working directory. Raises SpecError with all
    problems, sorted by line.
    """
    path = str(path)
    reset_effort()
    return SpecLoader(path, _get_source(path, text), overrides or {}, checking, case).load_spec()


def _get_source(path: str, text: str | SourceFile | None) -> SourceFile:
    return text if isinstance(text, SourceFile) else read_source(path, text)


def load_with_cases(
    path: str,
    overrides: Overrides | None = None,
    checking: bool = True,
    text: str | SourceFile | None = None,
    files: NamedFiles | None = None,
) -> tuple[Spec, dict[str, Spec]]:
    """Load the scene and each of its load cases, by name, from one reading of a file or of a text in its place.

    files: the files that the spec names; None: they are next to the spec

    Raises SpecError with all problems of the scene, or else with those of all cases, each naming its case.
    """
    reset_effort()
    source = _get_source(path, text)
    spec = SpecLoader(path, source, overrides or {}, checking, None, files).load_spec()
    cases: dict[str, Spec] = {}
    problems: list[Problem] = []
    for name in spec.cases:
        try:
            cases[name] = SpecLoader(path, source, overrides or {}, checking, name, files).load_spec()
        except SpecError as error:
            problems += [problem._replace(message=f"in case {name}: {problem.message}") for problem in error.problems]
    if problems:
        raise SpecError(*problems)
    return spec, cases


class SpecLoader:
    """Loads one spec and collects its problems on the way."""

    def __init__(
        self,
        path: str,
        source: SourceFile,
        overrides: Overrides,
        checking: bool,
        case: str | None,
        files: NamedFiles | None = None,
    ) -> None:
        """files: the files that the spec names; None: they are next to the spec"""
        self.path, self.source, self.checking, self.case, self.files = path, source, checking, case, files
        self.problems = list(source.problems)
        self.warnings: list[Problem] = []
        self.unread: set[str] = set()
        if type(source.data) is not dict:
            # do not quote an unknown file
            kind = describe_kind(source.data) if type(source.data) is not str else "a text"
            message = f"a spec must be a mapping, this is {kind}"
            is_xml = type(source.data) is str and source.data.startswith("<")
            hint = IMPORT_HINT if is_xml else "start it with 'heun: 1'"
            raise SpecError(*self.problems, Problem("not-a-scene", message, source.location(()), hint))
        without_empty = {k: {} if v is None and k in (*NAMED_BLOCKS, "ground") else v for k, v in source.data.items()}
        settings, problems = parse_settings(overrides) if isinstance(overrides, Mapping) else ([*overrides], [])
        settings = [*(list_case_settings(case, source) if case is not None else ()), *settings]
        overridden, self.override_locations, unset = apply_settings(without_empty, settings)
        self.warnings += (
            iter_si_warnings(without_empty, overridden, self.override_locations) if self.override_locations else ()
        )
        problems += unset
        self.labels = source.labels
        if self.override_locations:
            overridden = self.split_set_labels(overridden)
        problems += iter_case_problems(without_empty, source) if CASES in source.data else ()
        self.data = self.complete_data(overridden)
        self.problems += problems

    @property
    def active_rules(self) -> list[Rule]:
        """The rules that are applied."""
        return [rule for rule in RULES if self.checking or not rule.for_check]

    def complete_data(self, data: dict[str, Any]) -> dict[str, Any]:
        """Return the data to read: with heun's words as types; a planar scene is completed to one in space."""
        data = replace_type_aliases(data)
        return complete_planar_scene(data) if data.get("space") == "planar" else data

    def split_set_labels(self, data: dict[str, Any]) -> dict[str, Any]:
        """Return the data without the labels that settings have put into it."""
        splitter = LabelSplitter()
        set_blocks = dict.fromkeys(str(path[0]) for path in self.override_locations)
        without_labels = splitter.split({block: data[block] for block in set_blocks if block in data})
        self.labels = {**self.labels, **splitter.labels} if splitter.labels else self.labels
        for path, finding, is_key in splitter.errors:
            self.problems.append(Problem(finding.code, finding.message, self.find_location(path, is_key), finding.hint))
        return replace_changed(data, without_labels)

    def find_location(self, path: Path_, key: bool = False) -> SourceLocation:
        """Return the location of the value at a path: in the file or on the command line."""
        for depth in range(len(path), 0, -1):
            set_location = self.override_locations.get(path[:depth])
            if set_location is not None:
                return SourceLocation(set_location.file, set_location.line, set_location.column, format_path(path))
        locations_below = [
            location for set_location, location in self.override_locations.items() if set_location[: len(path)] == path
        ]
        if locations_below and path not in self.source.values:  # a key that exists only because a key below it was set
            return SourceLocation(
                locations_below[0].file, locations_below[0].line, locations_below[0].column, format_path(path)
            )
        return self.source.location(path, key)

    def report(self, code: str, violation: Violation) -> None:
        """Add an error in what is read, unless it is the consequence of another."""
        self.unread.update(map(str, violation.path[:1]))
        if is_primary(code):
            self.problems.append(
                Problem(code, violation.message, self.find_location(violation.path, violation.key), violation.hint)
            )

    def load_spec(self) -> Spec:
        """Load the scene. Raises SpecError."""
        parameters, given_parameters = self.load_parameters()
        names = self.collect_names()
        scope = self.make_scope(parameters, given_parameters)
        tables = self.load_tables(scope)
        time_scope = replace(scope, joints=names.joints, tables=tables, in_time=True, points=names.points)
        context = ReadContext(scope, time_scope, names.points)
        reader = self.make_reader(context)
        document = reader.read_document()
        expectations = dict(self.iter_expectations(document))
        draft = DraftDocument(document._replace(expect=expectations), names, frozenset(self.unread), {})
        self.apply_rules(draft, reader.is_consequence)
        curves, surfaces, logo = self.load_curves(draft), self.load_meshes(document), self.load_logo(document)
        if self.problems:
            raise SpecError(*sort_problems(self.problems))
        values = {name: value for name, value in parameters.items() if value is not None}
        built_tables = {name: table for name, table in tables.items() if table is not None}
        warnings = tuple(sort_problems(self.warnings))
        source = self.source
        locations = self.collect_locations()
        meaning = ResolveInputs(
            source.file, source.sha256, values, built_tables, warnings, locations, curves, surfaces, self.case,
            self.labels, logo,
        )  # fmt: skip
        return self.resolve_document(draft.document, meaning)

    def make_scope(
        self, parameters: Mapping[str, float | None], given_parameters: Mapping[str, DimensionedParameter]
    ) -> Scope:
        """Make the scope of names that a constant number may use."""
        return Scope(parameters, given=given_parameters)

    def resolve_document(self, document: f.Document, meaning: ResolveInputs) -> Spec:
        """Resolve the document into a scene."""
        return resolve(document, meaning)

    def make_reader(self, context: ReadContext) -> DocumentReader:
        """Make the reader of entries whose values may refer to the context."""
        return DocumentReader(self.data, context, self.report)

    def iter_violations(self, draft: DraftDocument) -> Iterator[tuple[Rule, Violation]]:
        """Yield the violations of the active rules."""
        return iter_violations(self.active_rules, draft)

    def collect_names(self) -> SceneNames:
        """Collect everything that the spec names."""
        return SceneNames.from_data(self.data)

    def evaluate_parameter_block(self) -> Parameters:
        """Evaluate the parameters of the spec."""
        return evaluate_parameters(self.get_block("parameters"))

    def build_entry_table(
        self, name: str, entry: f.TableEntry, scope: Scope
    ) -> tuple[TableFunction | None, list[TableProblem]]:
        """Build the table of an entry, and list what is wrong with it."""
        from heuncli.scene.file_format.tables import build_table  # with csv 2 ms that few scenes need

        return build_table(name, entry, scope, self.get_named_files())

    def load_parameters(self) -> tuple[dict[str, float | None], dict[str, DimensionedParameter]]:
        """Return the values of the parameters (None for wrong ones), and those that have a dimension."""
        parameters = self.evaluate_parameter_block()
        for name, finding in parameters.findings:
            self.report(finding.code, Violation(("parameters", name), finding.message, finding.hint))
        return parameters.values, parameters.given_quantities

    def load_tables(self, scope: Scope) -> dict[str, TableFunction | None]:
        """Load the tables; None for wrong ones."""
        entries = self.get_block("tables")
        if not entries:
            return {}
        reader = self.make_reader(ReadContext(scope, scope))
        tables: dict[str, TableFunction | None] = {}
        for name, data in entries.items():
            path = ("tables", name)
            entry = reader.read_model(path, data, f.TableEntry)
            tables[name], problems = self.build_entry_table(name, entry, scope) if entry is not None else (None, [])
            if (
                entry is not None
                and entry.file is not None
                and (warning := self.get_named_files().find_outside_warning(entry.file))
            ):
                self.warnings.append(
                    Problem(warning.code, warning.message, self.find_location((*path, "file")), warning.hint)
                )
            self.report_file_problems(path, problems)
        return tables

    def load_curves(self, draft: DraftDocument) -> dict[int, Curve]:
        """Load the curves of expectations, by their index in the list; wrong ones are left out."""
        curve_items = {i: item for i, item in draft.document.expect.items() if item.curve is not None}
        if not curve_items:
            return {}
        from heuncli.base.units import TIME
        from heuncli.scene.file_format.file_contents import build_curve  # as for tables
        from heuncli.scene.file_format.rules.expect import find_x_quantity, iter_expected_quantities

        instants = list_instants(draft.document) if self.checking else ()
        run = (min(instants), max(instants)) if len(instants) > 1 else None
        curves: dict[int, Curve] = {}
        kinds = {path[1]: quantity for path, _, quantity in iter_expected_quantities(draft)}
        for i, item in curve_items.items():
            path = ("expect", i)
            x_quantity, quantity = find_x_quantity(item, draft), kinds.get(i)
            dimensions = (
                (TIME,) if x_quantity is None else x_quantity.dimensions,
                () if quantity is None else quantity.dimensions,
            )
            x_of = None if x_quantity is None else str(item.x)
            curve, problems = build_curve(item, x_of, run, dimensions, self.get_named_files())
            if curve is not None:
                curves[i] = curve
            if warning := self.get_named_files().find_outside_warning(str(item.curve)):
                self.warnings.append(
                    Problem(warning.code, warning.message, self.find_location((*path, "curve")), warning.hint)
                )
            self.report_file_problems(path, problems)
        return curves

    def load_meshes(self, document: f.Document) -> dict[str, TriangleMesh]:
        """Load the meshes of shapes, by file name; wrong ones are left out."""
        shapes = [
            (("bodies", name, "shapes", i), shape)
            for name, body in document.bodies.items()
            for i, shape in enumerate(body.shapes or ())
            if isinstance(shape, MeshShape)
        ]
        meshes: dict[str, tuple[TriangleMesh | None, list[TableProblem]]] = {}
        for path, shape in shapes:
            from heuncli.scene.file_format.file_contents import (  # few scenes have them
                check_mesh_mass,
                iter_mesh_warnings,
            )

            if shape.file not in meshes:
                meshes[shape.file] = self.load_mesh(shape.file)
            mesh, problems = meshes[shape.file]
            self.report_file_problems(path, problems if mesh is None else [*check_mesh_mass(shape, mesh)])
            for warning in iter_mesh_warnings(shape, mesh, self.get_named_files()):
                self.warnings.append(
                    Problem(warning.code, warning.message, self.find_location((*path, "file")), warning.hint)
                )
        return {file: mesh for file, (mesh, _) in meshes.items() if mesh is not None}

    def load_mesh(self, file: str) -> tuple[TriangleMesh | None, list[TableProblem]]:
        """Load the mesh of a file, and list what is wrong with it."""
        from heuncli.scene.file_format.file_contents import read_mesh  # few scenes have them

        return read_mesh(file, self.get_named_files())

    def load_logo(self, document: f.Document) -> Logo | None:
        """Load the logo of the report; None, and reported, if the file is not a picture."""
        report = document.head.report
        if not isinstance(report, f.ReportEntry) or report.logo is None:
            return None
        from heuncli.scene.file_format.file_contents import read_logo  # few scenes have one

        path = ("report", "logo")
        if warning := self.get_named_files().find_outside_warning(report.logo):
            self.warnings.append(Problem(warning.code, warning.message, self.find_location(path), warning.hint))
        try:
            return read_logo(report.logo, self.get_named_files())
        except Finding as finding:
            self.report(finding.code, Violation(path, finding.message, finding.hint))
            return None

    def get_named_files(self) -> NamedFiles:
        """Return the files that the spec names."""
        if self.files is None:
            from heuncli.scene.file_format.named_files import NamedFiles  # with pathlib 3 ms that few scenes need

            self.files = NamedFiles(self.path)
        return self.files

    def report_file_problems(self, path: Path_, problems: Sequence[TableProblem]) -> None:
        """Report what is wrong with an entry that names a file: at its keys, or at a location in the file."""
        for item in problems:
            finding = item.finding
            if item.location is not None or item.is_warning:
                location = item.location or self.find_location((*path, *item.keys))
                problem = Problem(finding.code, finding.message, location, finding.hint)
                (self.warnings if item.is_warning else self.problems).append(problem)
            else:
                self.report(finding.code, Violation((*path, *item.keys), finding.message, finding.hint))

    def iter_expectations(self, document: f.Document) -> Iterator[tuple[int, f.ExpectEntry]]:
        """Yield the expectations that apply to the current load case, by their index in the list; report unknown
        cases.
        """
        cases = as_mapping(self.data.get(CASES))
        for i, item in document.expect.items():
            if item.case is not None and item.case not in cases:
                hint = suggest(item.case, cases, "cases") if cases else "cases: {NAME: {set: {...}}}"
                violation = Violation(("expect", i, "case"), f"there is no load case '{item.case}'", hint)
                self.report("unknown-case", violation)
            elif item.case is None or item.case == self.case:
                yield i, item

    def get_block(self, name: str) -> dict[str, Any]:
        """Return a block of named values; empty, and reported, if it is not a mapping."""
        value = self.data.get(name, {})
        if type(value) is not dict:
            self.report(
                "wrong-kind",
                Violation((name,), f"expected a mapping, found {describe_kind(value)}", "write names as its keys"),
            )
        return as_mapping(value)

    def apply_rules(self, draft: DraftDocument, is_consequence: Callable[[Path_], bool]) -> None:
        """Apply the rules and report their violations, except those that may be consequences of another error."""
        for rule, violation in self.iter_violations(draft):
            if rule.may_be_consequence and is_consequence(violation.path):
                continue
            problem = Problem(
                rule.code, violation.message, self.find_location(violation.path, violation.key), violation.hint
            )
            (self.warnings if rule.is_warning else self.problems).append(problem)

    def collect_locations(self) -> dict[str, SourceLocation]:
        """Collect the locations for later stages: of every entry, and of every value that may fail during the run."""
        return self.locate_paths((*self.list_located_paths(), *self.override_locations))

    def list_located_paths(self) -> list[Path_]:
        """List the paths of the file whose location later stages may need."""
        values = self.source.values
        return [path for path in values if 0 < len(path) <= 2 or (path and path[0] in LOCATED_BLOCKS)]

    def locate_paths(self, paths: Iterable[Path_]) -> dict[str, SourceLocation]:
        """Return the locations of paths, by the dotted form that users write."""
        return {format_path(path): self.find_location(path, key=len(path) <= 2) for path in paths}


def sort_problems(problems: list[Problem]) -> list[Problem]:
    """Sort problems by file, line and column, and remove duplicates."""
    locations = [p.location or SourceLocation("", 0, 0) for p in problems]
    order = sorted(range(len(problems)), key=lambda i: (locations[i].file, locations[i].line, locations[i].column))
    return list(dict.fromkeys(problems[i] for i in order))
