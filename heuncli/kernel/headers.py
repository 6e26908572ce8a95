"""What Cython has to know of the kernel, read from its Python texts: no declaration stands twice (one_module.py).

What a module says in Python, and what that is for C:

    from math import sqrt                   in the block for plain Python: the function of C's library; so from libm.py.
                                            What is imported from the kernel is there, in the one module
    GUIDE, DOT = range(2)                   in that block: an enumeration
    SAFETY = 0.9                            at the top: a number of C
    class Body(Struct)                      a struct (structs.py), field by field
    def push(...)                           a C function, if it gives a C type or takes a pointer or a struct; where no
                                            object of Python is in it, without exceptions and without the interpreter's
                                            lock. Of modules that are not compiled themselves: inlined where it is used
    class Workspace                         an extension type: the attributes that `__init__` annotates, and the methods
                                            that are C functions
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import TypeGuard

from heuncli.kernel.modules import DECLARED, MODULES

PACKAGE = "heuncli.kernel"
NUMBERS = {"int": "int", "float": "double", "bool": "bint", "Size": "Py_ssize_t"}
OBJECTS = ("bytearray", "dict", "list", "tuple")
EXTENSION_TYPES = ("Expressions", "Integration", "Memory", "Workspace")
POINTERS = {"p_void": "void *", "p_char": "char *", "p_int": "int *", "p_double": "double *", "pp_double": "double **"}


def declare(modules: dict[str, ast.Module]) -> str:
    """The declarations of all modules of the kernel: enumerations, structs, extension types."""
    structs = known_structs(modules)
    types = [node for name in MODULES for node in modules[name].body if isinstance(node, ast.ClassDef)]
    parts = [
        *(enumeration(module.body if name in DECLARED else plain_block(module)) for name, module in modules.items()),
        [struct(node, structs) for name in DECLARED for node in modules[name].body if is_struct(node, structs)],
        [f"cdef class {node.name}\n" for node in types],
        [extension_type(node, structs) for node in types],
    ]
    return "\n".join("".join(part) for part in parts if part)


def known_structs(modules: dict[str, ast.Module]) -> frozenset[str]:
    """The names of all structs of the kernel."""
    return frozenset(node.name for name in DECLARED for node in modules[name].body if isinstance(node, ast.ClassDef))


def plain_block(module: ast.Module) -> list[ast.stmt]:
    """What stands below `if not cython.compiled:`."""
    blocks = [node for node in module.body if isinstance(node, ast.If)]
    return next(node.body for node in blocks if ast.unparse(node.test) == "not cython.compiled")


# Imports and constants


def library(block: list[ast.stmt]) -> list[str]:
    """The names that a module takes of C's library."""
    return [
        alias.name
        for node in block
        if isinstance(node, ast.ImportFrom) and node.module in ("math", f"{PACKAGE}.libm")
        for alias in node.names
    ]


def enumeration(block: list[ast.stmt]) -> list[str]:
    """The whole numbers of a block, by their names."""
    lines = []
    for node in block:
        if isinstance(node, ast.Assign):
            target, value = node.targets[0], node.value
            names = [ast.unparse(part) for part in (target.elts if isinstance(target, ast.Tuple) else [target])]
            if isinstance(value, ast.Call) and ast.unparse(value.func) == "range":
                numbers = list(range(*(ast.literal_eval(argument) for argument in value.args)))
            else:
                numbers = [ast.literal_eval(part) for part in (value.elts if isinstance(value, ast.Tuple) else [value])]
            lines.append(", ".join(f"{name} = {number}" for name, number in zip(names, numbers, strict=True)))
    return ["cdef enum:\n", *(f"    {line}\n" for line in lines)] if lines else []


def is_float(node: ast.stmt) -> TypeGuard[ast.Assign]:
    """Whether a statement gives a name to a number with a point."""
    return isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, float)


def floats(module: ast.Module) -> list[tuple[str, float]]:
    """The names at the top that are numbers with a point, and these."""
    return [(ast.unparse(node.targets[0]), ast.literal_eval(node.value)) for node in module.body if is_float(node)]


# Types


def c_type(node: ast.expr, structs: frozenset[str]) -> str | None:
    """A type of Cython's that an annotation names, or a struct; None for an object of Python."""
    if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "cython":
        return POINTERS.get(node.attr, node.attr)
    if isinstance(node, ast.Subscript) and ast.unparse(node.value) == "cython.pointer":
        return pointer_to(str(c_type(node.slice, structs)))
    name = ast.unparse(node)
    return name if name in structs else None


def pointer_to(kind: str) -> str:
    """The type of a pointer to a type."""
    return f"{kind}*" if kind.endswith("*") else f"{kind} *"


def object_type(node: ast.expr | None) -> str:
    """An object of Python as Cython declares it: the built-in ones and the kernel's own by their types."""
    name = "" if node is None else ast.unparse(node).partition("[")[0]
    return name if name in (*OBJECTS, *EXTENSION_TYPES) else "object"


def field_type(node: ast.expr, structs: frozenset[str]) -> str:
    """The type of a field as structs.py says."""
    name = ast.unparse(node)
    if name in NUMBERS or name in structs:
        return NUMBERS.get(name, name)
    assert isinstance(node, ast.Subscript), name
    if ast.unparse(node.value) in ("list", "array", "Pointer"):
        return pointer_to(field_type(node.slice, structs))
    raise ValueError(f"no type of a field: {name}")


def of(kind: str, name: str) -> str:
    """A declaration of a name."""
    return f"{kind}{name}" if kind.endswith("*") else f"{kind} {name}"


# Structs and extension types


def is_struct(node: ast.stmt, structs: frozenset[str]) -> TypeGuard[ast.ClassDef]:
    """Whether a statement is a struct of the kernel."""
    return isinstance(node, ast.ClassDef) and node.name in structs


def struct(node: ast.ClassDef, structs: frozenset[str]) -> str:
    """A struct; a tuple of structs of one kind is an array."""
    lines = [f"cdef struct {node.name}:\n"]
    for field in node.body:
        if isinstance(field, ast.AnnAssign):
            kind, name = field.annotation, ast.unparse(field.target)
            if isinstance(kind, ast.Subscript) and isinstance(kind.slice, ast.Tuple):
                name += f"[{len(kind.slice.elts)}]"
                kind = kind.slice.elts[0]
            lines.append(f"    {of(field_type(kind, structs), name)}\n")
    return "".join(lines)


def extension_type(node: ast.ClassDef, structs: frozenset[str]) -> str:
    """The type of objects that hold structs: its attributes, and the methods that are C functions."""
    lines = [f"cdef class {node.name}:\n"]
    methods = [method for method in node.body if isinstance(method, ast.FunctionDef)]
    first = next(method for method in methods if method.name == "__init__")
    for line in ast.walk(first):
        if isinstance(line, ast.AnnAssign) and isinstance(line.target, ast.Attribute):
            kind = c_type(line.annotation, structs) or object_type(line.annotation)
            lines.append(f"    cdef {of(kind, line.target.attr)}\n")
    lines += [f"    {text}\n" for method in methods for text in signature(method, structs)]
    return "".join(lines)


# Functions


def inlined_functions(module: ast.Module, structs: frozenset[str]) -> list[str]:
    """The whole functions of a module that is not compiled itself."""
    return [inlined(node, structs) for node in module.body if isinstance(node, ast.FunctionDef)]


def signature(node: ast.FunctionDef, structs: frozenset[str]) -> Iterator[str]:
    """The signature of what is a C function."""
    assert node.returns is not None, node.name
    gives = c_type(node.returns, structs)
    takes = [
        (argument, c_type(argument.annotation, structs) if argument.annotation else None) for argument in node.args.args
    ]
    if gives is None and not any(kind and (kind.endswith("*") or kind in structs) for _, kind in takes):
        return
    words = [
        argument.arg if argument.arg == "self" else of(kind or object_type(argument.annotation), argument.arg)
        for argument, kind in takes
    ]
    told = "" if gives is None or any(kind is None for _, kind in takes) else " noexcept nogil"
    yield f"cdef {of(gives or object_type(node.returns), node.name)}({', '.join(words)}){told}"


def inlined(node: ast.FunctionDef, structs: frozenset[str]) -> str:
    """A whole function, in which every number and every value is declared."""
    assert node.returns is not None, node.name
    words = [of(field_type(a.annotation, structs), a.arg) for a in node.args.args if a.annotation is not None]
    head = f"cdef inline {of(field_type(node.returns, structs), node.name)}({', '.join(words)}) noexcept nogil:\n"
    return head + "".join(statements(node.body[1:], structs, "    ")) + "\n"


def statements(body: list[ast.stmt], structs: frozenset[str], indent: str) -> Iterator[str]:
    """Statements with their declarations as C's."""
    for node in body:
        if isinstance(node, ast.AnnAssign) and node.value is not None:
            declared = of(field_type(node.annotation, structs), ast.unparse(node.target))
            yield f"{indent}cdef {declared} = {ast.unparse(node.value)}\n"
        elif isinstance(node, ast.If):
            yield f"{indent}if {ast.unparse(node.test)}:\n"
            yield from statements(node.body, structs, indent + "    ")
            assert not node.orelse
        else:
            yield f"{indent}{ast.unparse(node)}\n"
