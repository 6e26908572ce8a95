"""The kernel's headers, which are made of its text, say of structs, numbers and functions what the text says."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from heuncli.kernel import headers
from heuncli.kernel.choose import scene, structs
from heuncli.kernel.modules import DECLARED, MODULES
from heuncli.tree import tables as records
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


@cache
def header(name: str) -> str:
    return headers.header(FOLDER, name)


def kind(annotation: ast.expr | None) -> str:
    """A type as C names it."""
    assert annotation is not None
    return FOR_C.get(ast.unparse(annotation), ast.unparse(annotation))


def inlined(name: str) -> tuple[str, str]:
    """Head and body of a function in the header of algebra.py."""
    found = re.search(rf"^(cdef inline [^\n]*\b{name}\(.*?nogil:)\n(.*?)(?=^\S|\Z)", header("algebra"), re.S | re.M)
    assert found is not None, name
    return found[1], found[2]


def fields(struct: str, module: str) -> list[tuple[str, str]]:
    """Name and type of a struct's fields in a header."""
    found = re.search(rf"cdef struct {struct}:\n((?:    [^\n]*\n)+)", header(module))
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
    assert fields(record.__name__, "scene") == wanted
    assert list(records.type_of(record).names or ()) == [name for name, _ in wanted]


@pytest.mark.parametrize("name", VALUES)
def test_values(name: str) -> None:
    """Vectors, matrices and programs have the same parts for C, in plain Python and for NumPy."""
    of = vars(scene)[name]
    parts = list(records.type_of(of).names or ())
    assert [part for part, _ in fields(name, "programs" if name == "Program" else "algebra")] == parts
    value = of(*range(len(parts)))
    assert [getattr(value, part) for part in parts] == list(range(len(parts)))


def test_a_struct_begins_as_zeros() -> None:
    """As C has it: numbers are 0, structs within a struct as well."""
    body = scene.Body.blank()
    assert (body.parent, body.mass, body.r.y, body.A.zz, body.turning.xx) == (0, 0.0, 0.0, 0.0, 0.0)
    made = scene.Scene.blank()
    assert (made.limits.dodges, made.gravity.x, made.bodies) == (0, 0.0, None)


@pytest.mark.parametrize("name", [*DECLARED, *MODULES])
def test_whole_numbers(name: str) -> None:
    """Enumerations count as the text does."""
    plain: dict[str, object] = {}
    module = ast.parse((FOLDER / f"{name}.py").read_text(encoding="utf-8"))
    block = module.body if name in DECLARED else headers.plain_block(module)
    given = [node for node in block if isinstance(node, ast.Assign)]
    exec(ast.unparse(ast.Module(given, [])), plain)
    wanted = {key: number for key, number in plain.items() if isinstance(number, int)}
    told = dict(re.findall(r"\b([A-Z]\w*) = (-?\d+)", header(name)))
    assert {key: int(number) for key, number in told.items()} == wanted


@pytest.mark.parametrize("name", MODULES)
def test_what_one_module_takes_from_another_is_declared_there(name: str) -> None:
    for origin, names in re.findall(r"^from heuncli\.kernel\.(\w+) cimport (.*)$", header(name), re.M):
        for word in names.split(", "):
            assert re.search(rf"[ *]{word}\b(?! cimport)", header(origin)), f"{origin}.py declares no {word}"


TEXT = '''
from heuncli.kernel.shadow import cython
if not cython.compiled:
    from math import fabs
    from heuncli.kernel.libm import NAN
    from heuncli.kernel.scene import Body, Scene
    FEW, MANY = range(3, 5)
LEAST = 0.5
TOLD = {"few": FEW}
def told(scene: cython.pointer[Scene], body: cython.pointer[Body], n: cython.int) -> cython.void:
    """Numbers and structs alone."""
def asked(rows: Sequence[float], n: cython.int) -> cython.size_t:
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
HEADER = """\
# Made of tree.py by headers.py.

from heuncli.kernel.scene cimport Body, Scene
from libc.math cimport NAN, fabs

cdef enum:
    FEW = 3, MANY = 4

cdef double LEAST

cdef void told(Scene *scene, Body *body, int n) noexcept nogil
cdef size_t asked(object rows, int n)
cdef tuple given(Body *body, dict names)

cdef class Room:
    cdef int n
    cdef list names
    cdef Scene of
    cdef double *at(self, int i)
"""


def test_what_is_declared_of_a_text(tmp_path: Path) -> None:
    for name in DECLARED:
        (tmp_path / f"{name}.py").write_text((FOLDER / f"{name}.py").read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "tree.py").write_text(TEXT, encoding="utf-8")
    assert headers.header(tmp_path, "tree") == HEADER


def test_headers_that_say_the_same_stay_as_they_are(tmp_path: Path) -> None:
    """What is compiled from them is compiled again where one is newer."""
    headers.write(FOLDER, tmp_path)
    folder = tmp_path / "heuncli" / "kernel"
    first = {path: path.stat().st_mtime_ns for path in folder.iterdir()}
    assert {path.name for path in first} == {f"{name}.pxd" for name in (*DECLARED, *MODULES, "__init__")}
    (folder / "tree.pxd").write_text("another", encoding="utf-8")
    headers.write(FOLDER, tmp_path)
    changed = [path.name for path, time in first.items() if path.stat().st_mtime_ns != time]
    assert changed == ["tree.pxd"]
    assert (folder / "tree.pxd").read_text(encoding="utf-8") == header("tree")


def test_answers_fill_their_records() -> None:
    """Sizes as kernel/answers.py writes them."""
    sizes = {"BODY": 30, "FREEDOM": 4, "LOAD": 20, "CLOSURE": 14, "PART": 16, "STATE": 4}
    assert {name: getattr(records, f"{name}_ANSWER").itemsize // 8 for name in sizes} == sizes


def test_a_table_takes_rows_of_different_fields() -> None:
    """What only later rows give is kept, and what a row leaves out is zero."""
    made = records.table(scene.Closure, [{"a": 1, "length": 2.0}, {"a": 3, "e": (4.0, 5.0, 6.0)}])
    assert made["a"].tolist() == [1, 3]
    assert made["length"].tolist() == [2.0, 0.0]
    assert made["e"].tolist() == [(0.0, 0.0, 0.0), (4.0, 5.0, 6.0)]
