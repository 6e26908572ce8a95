"""What stands twice in the kernel, for C and for plain Python, is the same: the algebra and the structs."""

from __future__ import annotations

import ast
import re

import pytest

from heuncli.kernel.choose import scene
from heuncli.kernel.form import FOLDER
from heuncli.tree import tables as records

FOR_C = {"int": "int", "float": "double"}
FUNCTIONS = [
    node
    for node in ast.parse((FOLDER / "algebra.py").read_text(encoding="utf-8")).body
    if isinstance(node, ast.FunctionDef)
]
RECORDS = [r for r in vars(scene).values() if isinstance(r, type) and issubclass(r, scene.Record) and r != scene.Record]


def text(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")


def kind(annotation: ast.expr | None) -> str:
    """A type as C names it."""
    assert annotation is not None
    return FOR_C.get(ast.unparse(annotation), ast.unparse(annotation))


def inlined(name: str) -> tuple[str, str]:
    """Head and body of a function of algebra.pxd."""
    of = rf"^(cdef inline [^\n]*\b{name}\(.*?nogil:)[^\n]*\n(.*?)(?=^\S|\Z)"
    found = re.search(of, text("algebra.pxd"), re.S | re.M)
    assert found is not None, name
    return found[1], found[2]


def fields(struct: str, file: str) -> list[tuple[str, str]]:
    """Name and type of a struct's fields in a .pxd."""
    found = re.search(rf"cdef struct {struct}:[^\n]*\n((?:    [^\n]*\n)+)", text(file))
    assert found is not None, struct
    words = [line.split("#")[0].split() for line in found[1].splitlines()]
    return [(name, of) for of, name in words]


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f.name)
def test_algebra(function: ast.FunctionDef) -> None:
    """The same arguments, the same operations in the same order."""
    head, body = inlined(function.name)
    arguments = ", ".join(f"{kind(a.annotation)} {a.arg}" for a in function.args.args)
    assert head == f"cdef inline {kind(function.returns)} {function.name}({arguments}) noexcept nogil:"
    plain: list[ast.stmt] = []
    for node in function.body[1:]:  # without the docstring
        if isinstance(node, ast.AnnAssign):
            assert node.value is not None
            declaration = f"cdef {kind(node.annotation)} {ast.unparse(node.target)} ="
            assert declaration in body
            node = ast.parse(f"{ast.unparse(node.target)} = {ast.unparse(node.value)}").body[0]
        plain.append(node)
    written = ast.parse("def f():\n" + re.sub(r"\bcdef \w+ (?=\w+ =)", "", body)).body[0]
    assert isinstance(written, ast.FunctionDef)
    assert [ast.dump(node) for node in written.body] == [ast.dump(node) for node in plain]


def test_nothing_stands_in_the_compiled_algebra_alone() -> None:
    assert set(re.findall(r"^cdef inline \w+ (\w+)\(", text("algebra.pxd"), re.M)) == {f.name for f in FUNCTIONS}


@pytest.mark.parametrize("record", RECORDS, ids=lambda r: r.__name__)
def test_structs(record: type[scene.Record]) -> None:
    """Field by field, in order; and the NumPy table has the same."""
    wanted = [(name, FOR_C.get(of, of)) for name, of in record.__annotations__.items()]
    assert fields(record.__name__, "scene.pxd") == wanted
    assert list(records.type_of(record).names or ()) == [name for name, _ in wanted]


@pytest.mark.parametrize("name", records.VALUES)
def test_values(name: str) -> None:
    """Vectors, matrices and programs have the same parts for C, in plain Python and for NumPy."""
    parts = list(records.VALUES[name].names or ())
    assert [part for part, _ in fields(name, "expressions.pxd" if name == "Program" else "algebra.pxd")] == parts
    value = scene.VALUES[name](*range(len(parts)))
    assert [getattr(value, part) for part in parts] == list(range(len(parts)))


@pytest.mark.parametrize("first", ["TURN_IN_PARENT", "FORCE", "GUIDE"])
def test_kinds(first: str) -> None:
    """Enumerations count alike."""
    listed = next(line for line in text("scene.pxd").splitlines() if line.strip().startswith(first))
    names = [name.strip() for name in listed.split(",")]
    assert [getattr(scene, name) for name in names] == list(range(len(names)))


def test_answers_fill_their_records() -> None:
    """Sizes as kernel/workspace.py writes them."""
    sizes = {"BODY": 30, "FREEDOM": 4, "LOAD": 16, "CLOSURE": 14, "STATE": 4}
    assert {name: getattr(records, f"{name}_ANSWER").itemsize // 8 for name in sizes} == sizes


def test_a_table_takes_rows_of_different_fields() -> None:
    """What only later rows give is kept, and what a row leaves out is zero."""
    made = records.table(scene.Closure, [{"a": 1, "length": 2.0}, {"a": 3, "e": (4.0, 5.0, 6.0)}])
    assert made["a"].tolist() == [1, 3]
    assert made["length"].tolist() == [2.0, 0.0]
    assert made["e"].tolist() == [(0.0, 0.0, 0.0), (4.0, 5.0, 6.0)]
