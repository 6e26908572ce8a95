"""The kernel's one compiled module, made of its text, says of structs, numbers and functions what that text says."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from heuncli.kernel import headers, one_module
from heuncli.kernel.choose import scene, structs
from heuncli.kernel.modules import MODULES
from heuncli.multibody.tree import tables as records
from tests.shared.folders import KERNEL as FOLDER

FOR_C = {"int": "int", "float": "double"}
FUNCTIONS = [
    node
    for node in ast.parse((FOLDER / "algebra.py").read_text(encoding="utf-8")).body
    if isinstance(node, ast.FunctionDef)
]
ROWS = [
    r for r in vars(scene).values() if isinstance(r, type) and issubclass(r, structs.Record) and r != structs.Record
]
VALUES = ["Vec3", "Mat3", "Sym3", "Ldl3", "Program"]


TEXTS = one_module.parse_modules(FOLDER)
DECLARATIONS = headers.generate_declarations(TEXTS)
INLINED = "\n".join(headers.generate_inline_functions(TEXTS["algebra"], headers.find_struct_names(TEXTS)))


def kind(annotation: ast.expr | None) -> str:
    """A type as C names it."""
    assert annotation is not None
    return FOR_C.get(ast.unparse(annotation), ast.unparse(annotation))


def inlined(name: str) -> tuple[str, str]:
    """Head and body of a function of algebra.py."""
    found = re.search(rf"^(cdef inline [^\n]*\b{name}\(.*?nogil:)\n(.*?)(?=^\S|\Z)", INLINED, re.S | re.M)
    assert found is not None, name
    return found[1], found[2]


def fields(struct: str) -> list[tuple[str, str]]:
    """Name and type of a struct's declared fields."""
    found = re.search(rf"cdef struct {struct}:\n((?:    [^\n]*\n)+)", DECLARATIONS)
    assert found is not None, struct
    return [(name, of) for of, name in (line.split() for line in found[1].splitlines())]


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f.name)
def test_algebra(function: ast.FunctionDef) -> None:
    """The same operations in the same order, and every value declared."""
    head, body = inlined(function.name)
    arguments = ", ".join(f"{kind(a.annotation)} {a.arg}" for a in function.args.args)
    assert head == f"cdef inline {kind(function.returns)} {function.name}({arguments}) noexcept nogil:"
    plain: list[ast.stmt] = []
    for node in function.body[1:]:
        if isinstance(node, ast.AnnAssign):
            assert node.value is not None
            declaration = f"cdef {kind(node.annotation)} {ast.unparse(node.target)} ="
            assert declaration in body
            node = ast.parse(f"{ast.unparse(node.target)} = {ast.unparse(node.value)}").body[0]
        plain.append(node)
    written = ast.parse("def f():\n" + re.sub(r"\bcdef \w+ (?=\w+ =)", "", body)).body[0]
    assert isinstance(written, ast.FunctionDef)
    assert [ast.dump(node) for node in written.body] == [ast.dump(node) for node in plain]


@pytest.mark.parametrize("record", ROWS, ids=lambda r: r.__name__)
def test_rows(record: type[structs.Record]) -> None:
    """Field by field, in order; and the NumPy table has the same."""
    wanted = [(name, FOR_C.get(of, of)) for name, of in record.__annotations__.items()]
    assert fields(record.__name__) == wanted
    assert list(records.struct_dtype(record).names or ()) == [name for name, _ in wanted]


@pytest.mark.parametrize("name", VALUES)
def test_values(name: str) -> None:
    """Vectors, matrices and programs have the same parts for C, in plain Python and for NumPy."""
    of = vars(scene)[name]
    parts = list(records.struct_dtype(of).names or ())
    assert [part for part, _ in fields(name)] == parts
    value = of(*range(len(parts)))
    assert [getattr(value, part) for part in parts] == list(range(len(parts)))


def test_a_struct_begins_as_zeros() -> None:
    """As C has it: numbers are 0, structs within a struct as well."""
    body = scene.Body.blank()
    assert (body.parent, body.mass, body.r.y, body.A.zz, body.A_factors.xx) == (0, 0.0, 0.0, 0.0, 0.0)
    made = scene.Scene.blank()
    assert (made.limits.singular_retries, made.gravity.x, made.bodies) == (0, 0.0, None)


def test_whole_numbers() -> None:
    """Enumerations count as the texts do."""
    wanted: dict[str, int] = {}
    for module in TEXTS.values():
        plain: dict[str, object] = {}
        exec(ast.unparse(ast.Module([node for node in module.body if headers.is_integer_constant(node)], [])), plain)
        wanted |= {key: number for key, number in plain.items() if isinstance(number, int)}
    told = dict(re.findall(r"\b([A-Z]\w*) = (-?\d+)", DECLARATIONS))
    assert {key: int(number) for key, number in told.items()} == wanted


def test_what_a_module_takes_from_another_has_the_same_name_there() -> None:
    """In the one module nothing has two names, and what is not imported would be there all the same."""
    names = {(module, name) for module, name, _ in one_module.iter_defined_names(TEXTS)}
    for module in MODULES:
        for node in TEXTS[module].body:
            if isinstance(node, ast.ImportFrom) and node.module != "heuncli.kernel.declarations":
                assert not [alias.name for alias in node.names if alias.asname], module
                origin = (node.module or "").removeprefix("heuncli.kernel.")
                if origin in TEXTS:
                    assert {(origin, alias.name) for alias in node.names} <= names, module


def test_a_name_has_one_meaning_in_the_kernel() -> None:
    one_module.refuse_duplicates(TEXTS)
    wanted = {
        "def order_all(n: cython.int) -> cython.int:\n    return n": (
            r"order_all is in tree\.py:1 and in selection\.py:\d+"
        ),
        "SAFETY = 2.0": r"SAFETY is in tree\.py:1 and in judging\.py:\d+",
        "def sqrt(x: cython.double) -> cython.double:\n    return x": r"sqrt is in C's library and in tree\.py:1",
        "OF, sum = range(2)": r"sum is in Python itself and in tree\.py:1",
    }
    for text, message in wanted.items():
        more = ast.parse(text).body
        tree = ast.Module([*more, *TEXTS["tree"].body], [])
        with pytest.raises(one_module.DuplicateName, match=message):
            one_module.refuse_duplicates(TEXTS | {"tree": tree})


TEXT = '''
from math import fabs
from heuncli.kernel.declarations import *
from heuncli.kernel.libm import NAN
FEW, MANY = range(3, 5)
LEAST = 0.5
TOLD = {"few": FEW}
def told(scene: cython.pointer[Scene], body: cython.pointer[Body], n: cython.int) -> cython.void:
    """Numbers and structs alone."""
def asked(
    rows: Sequence[float], n: cython.int
) -> cython.size_t:
    """With an object: it may raise."""
def given(body: cython.pointer[Body], names: dict[str, float]) -> tuple[float, ...]:
    """An object out of a struct."""
def open(n: cython.int, x: cython.double[::1]) -> float:
    """For Python alone."""
class Room:
    """Holds a struct."""
    def __init__(self, n: cython.int) -> None:
        self.n: cython.int = n
        self.names: list[str] = []
        self.of: Scene = Scene.blank()
    def at(self, i: cython.int) -> cython.p_double:
        """A pointer."""
    def size(self) -> int:
        """For Python alone."""
'''
DECLARED_OF_IT = """\
cdef enum:
    FEW = 3, MANY = 4
"""
TYPE_OF_IT = """\
cdef class Room:
    cdef int n
    cdef list names
    cdef Scene of
    cdef double *at(self, int i)
"""
INCLUDED = '''




TOLD = {"few": FEW}
cdef void told(Scene *scene, Body *body, int n) noexcept nogil:
    """Numbers and structs alone."""
cdef size_t asked(object rows, int n):


    """With an object: it may raise."""
cdef tuple given(Body *body, dict names):
    """An object out of a struct."""
def open(n: cython.int, x: cython.double[::1]) -> float:
    """For Python alone."""
cdef class Room:
    """Holds a struct."""
    def __init__(self, n: cython.int) -> None:
        self.n: cython.int = n
        self.names: list[str] = []
        self.of: Scene = Scene.blank()
    cdef double *at(self, int i):
        """A pointer."""
    def size(self) -> int:
        """For Python alone."""
'''


def test_what_becomes_of_a_text() -> None:
    module = ast.parse(TEXT)
    texts = TEXTS | {"tree": module}
    declared = headers.generate_declarations(texts)
    assert DECLARED_OF_IT in declared and TYPE_OF_IT in declared
    assert headers.find_float_constants(module) == [("LEAST", 0.5)]
    assert headers.find_library_names(module) == ["fabs", "NAN"]
    assert one_module.convert_module(TEXT, module, headers.find_struct_names(texts)).split("\n") == [
        "",
        *INCLUDED.split("\n"),
    ]


@pytest.mark.heavy  # texts, which are those of both kernels
def test_every_module_is_included_line_for_line(tmp_path: Path) -> None:
    """So errors name the right line; and what says the same stays as it is, with its time."""
    package = one_module.write_sources(FOLDER, tmp_path).parent
    for name in MODULES:
        plain = (FOLDER / f"{name}.py").read_text(encoding="utf-8").splitlines()
        made = (package / f"{name}.pxi").read_text(encoding="utf-8").splitlines()
        kept = [made == text for made, text in zip(made, plain, strict=True) if made.strip()]
        assert len(made) == len(plain) and kept.count(False) < kept.count(True), name
    first = {path: path.stat().st_mtime_ns for path in package.iterdir()}
    (package / "tree.pxi").write_text("another", encoding="utf-8")
    one_module.write_sources(FOLDER, tmp_path)
    assert [path.name for path, time in first.items() if path.stat().st_mtime_ns != time] == ["tree.pxi"]


def test_answers_fill_their_records() -> None:
    """Sizes as kernel/solutions.py writes them."""
    sizes = {"bodies": 30, "freedoms": 4, "loads": 22, "rows": 14, "parts": 16, "whole": 4}
    assert {name: kind.itemsize // 8 for name, kind in records.SOLUTION_PARTS.items()} == sizes
