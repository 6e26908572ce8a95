"""Generate the declarations that Cython needs from the kernel's Python texts, so that none is written twice
(one_module.py).

What a module says in Python, and what that becomes in C:

    from math import sqrt                   the function of C's library; so from libm.py. Imports from the kernel need
                                            nothing: all is in the one module
    GUIDE, DOT = range(2)                   an enumeration
    SAFETY = 0.9                            a C constant
    class Body(Struct)                      a struct (structs.py), field by field
    def push_load(...)                      a C function, if it returns a C type or takes a pointer or a struct; if no
                                            Python object is in it, without exceptions and without the interpreter's
                                            lock. In modules that are not compiled themselves: inlined where it is used
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


def generate_declarations(modules: dict[str, ast.Module]) -> str:
    """Generate the declarations of all kernel modules: enumerations, structs, extension types."""
    structs = find_struct_names(modules)
    types = [node for name in MODULES for node in modules[name].body if isinstance(node, ast.ClassDef)]
    parts = [
        *(declare_enumeration(module) for module in modules.values()),
        [declare_struct(node, structs) for name in DECLARED for node in modules[name].body if is_struct(node, structs)],
        [f"cdef class {node.name}\n" for node in types],
        [declare_extension_type(node, structs) for node in types],
    ]
    return "\n".join("".join(part) for part in parts if part)


def find_struct_names(modules: dict[str, ast.Module]) -> frozenset[str]:
    """Return the names of all structs of the kernel."""
    return frozenset(node.name for name in DECLARED for node in modules[name].body if isinstance(node, ast.ClassDef))


# Imports and constants


def find_library_names(module: ast.Module) -> list[str]:
    """Return the names that a module imports from C's library."""
    return [
        alias.name
        for node in module.body
        if isinstance(node, ast.ImportFrom) and node.module in ("math", f"{PACKAGE}.libm")
        for alias in node.names
    ]


def is_integer_constant(node: ast.stmt) -> TypeGuard[ast.Assign]:
    """Return whether a statement names one or more whole numbers."""
    if not isinstance(node, ast.Assign):
        return False
    value = node.value
    if isinstance(value, ast.Call):
        return ast.unparse(value.func) == "range"
    parts = value.elts if isinstance(value, ast.Tuple) else [value]
    return all(isinstance(part, ast.Constant) and type(part.value) is int for part in parts)


def declare_enumeration(module: ast.Module) -> list[str]:
    """Declare the whole numbers of a module by their names."""
    lines = []
    for node in module.body:
        if is_integer_constant(node):
            target, value = node.targets[0], node.value
            names = [ast.unparse(part) for part in (target.elts if isinstance(target, ast.Tuple) else [target])]
            if isinstance(value, ast.Call):
                numbers = list(range(*(ast.literal_eval(argument) for argument in value.args)))
            else:
                numbers = [ast.literal_eval(part) for part in (value.elts if isinstance(value, ast.Tuple) else [value])]
            lines.append(", ".join(f"{name} = {number}" for name, number in zip(names, numbers, strict=True)))
    return ["cdef enum:\n", *(f"    {line}\n" for line in lines)] if lines else []


def is_float_constant(node: ast.stmt) -> TypeGuard[ast.Assign]:
    """Return whether a statement names a number with a decimal point."""
    return isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, float)


def find_float_constants(module: ast.Module) -> list[tuple[str, float]]:
    """Return the names and values of a module's constants with a decimal point."""
    return [
        (ast.unparse(node.targets[0]), ast.literal_eval(node.value)) for node in module.body if is_float_constant(node)
    ]


# Types


def find_c_type(node: ast.expr, structs: frozenset[str]) -> str | None:
    """Return the Cython type, or the struct, that an annotation names; None for a Python object."""
    if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "cython":
        return POINTERS.get(node.attr, node.attr)
    if isinstance(node, ast.Subscript) and ast.unparse(node.value) == "cython.pointer":
        return format_pointer(str(find_c_type(node.slice, structs)))
    name = ast.unparse(node)
    return name if name in structs else None


def format_pointer(kind: str) -> str:
    """Return the type of a pointer to a type."""
    return f"{kind}*" if kind.endswith("*") else f"{kind} *"


def object_type(node: ast.expr | None) -> str:
    """Return a Python object's type for Cython: built-in types and the kernel's own by name, else `object`."""
    name = "" if node is None else ast.unparse(node).partition("[")[0]
    return name if name in (*OBJECTS, *EXTENSION_TYPES) else "object"


def field_type(node: ast.expr, structs: frozenset[str]) -> str:
    """Return the C type of a struct field, as structs.py describes it. Raises ValueError for another type."""
    name = ast.unparse(node)
    if name in NUMBERS or name in structs:
        return NUMBERS.get(name, name)
    assert isinstance(node, ast.Subscript), name
    if ast.unparse(node.value) in ("list", "array", "Pointer"):
        return format_pointer(field_type(node.slice, structs))
    raise ValueError(f"no type of a field: {name}")


def typed_name(kind: str, name: str) -> str:
    """Return the declaration of a name with a type."""
    return f"{kind}{name}" if kind.endswith("*") else f"{kind} {name}"


# Structs and extension types


def is_struct(node: ast.stmt, structs: frozenset[str]) -> TypeGuard[ast.ClassDef]:
    """Return whether a statement is a struct of the kernel."""
    return isinstance(node, ast.ClassDef) and node.name in structs


def declare_struct(node: ast.ClassDef, structs: frozenset[str]) -> str:
    """Declare a struct; a tuple of structs of one kind is an array."""
    lines = [f"cdef struct {node.name}:\n"]
    for field in node.body:
        if isinstance(field, ast.AnnAssign) and ast.unparse(field.annotation) != "Computed":
            kind, name = field.annotation, ast.unparse(field.target)
            if isinstance(kind, ast.Subscript) and isinstance(kind.slice, ast.Tuple):
                name += f"[{len(kind.slice.elts)}]"
                kind = kind.slice.elts[0]
            lines.append(f"    {typed_name(field_type(kind, structs), name)}\n")
    return "".join(lines)


def declare_extension_type(node: ast.ClassDef, structs: frozenset[str]) -> str:
    """Declare the type of objects that hold structs: its attributes, and the methods that are C functions."""
    lines = [f"cdef class {node.name}:\n"]
    methods = [method for method in node.body if isinstance(method, ast.FunctionDef)]
    first = next(method for method in methods if method.name == "__init__")
    for line in ast.walk(first):
        if isinstance(line, ast.AnnAssign) and isinstance(line.target, ast.Attribute):
            kind = find_c_type(line.annotation, structs) or object_type(line.annotation)
            lines.append(f"    cdef {typed_name(kind, line.target.attr)}\n")
    lines += [f"    {text}\n" for method in methods for text in generate_signature(method, structs)]
    return "".join(lines)


# Functions


def generate_inline_functions(module: ast.Module, structs: frozenset[str]) -> list[str]:
    """Generate the functions of a module that is not compiled itself."""
    return [generate_inline_function(node, structs) for node in module.body if isinstance(node, ast.FunctionDef)]


def generate_signature(node: ast.FunctionDef, structs: frozenset[str]) -> Iterator[str]:
    """Yield the signature of a C function; nothing for a Python function."""
    assert node.returns is not None, node.name
    return_type = find_c_type(node.returns, structs)
    arguments = [
        (argument, find_c_type(argument.annotation, structs) if argument.annotation else None)
        for argument in node.args.args
    ]
    if return_type is None and not any(kind and (kind.endswith("*") or kind in structs) for _, kind in arguments):
        return
    parameters = [
        argument.arg if argument.arg == "self" else typed_name(kind or object_type(argument.annotation), argument.arg)
        for argument, kind in arguments
    ]
    suffix = "" if return_type is None or any(kind is None for _, kind in arguments) else " noexcept nogil"
    yield f"cdef {typed_name(return_type or object_type(node.returns), node.name)}({', '.join(parameters)}){suffix}"


def generate_inline_function(node: ast.FunctionDef, structs: frozenset[str]) -> str:
    """Generate a whole function in which every number and every value is declared."""
    assert node.returns is not None, node.name
    args = [typed_name(field_type(a.annotation, structs), a.arg) for a in node.args.args if a.annotation is not None]
    head = (
        f"cdef inline {typed_name(field_type(node.returns, structs), node.name)}({', '.join(args)}) noexcept nogil:\n"
    )
    return head + "".join(generate_statements(node.body[1:], structs, "    ")) + "\n"


def generate_statements(body: list[ast.stmt], structs: frozenset[str], indent: str) -> Iterator[str]:
    """Yield statements with their C declarations."""
    for node in body:
        if isinstance(node, ast.AnnAssign) and node.value is not None:
            declaration = typed_name(field_type(node.annotation, structs), ast.unparse(node.target))
            yield f"{indent}cdef {declaration} = {ast.unparse(node.value)}\n"
        elif isinstance(node, ast.If):
            yield f"{indent}if {ast.unparse(node.test)}:\n"
            yield from generate_statements(node.body, structs, indent + "    ")
            assert not node.orelse
        else:
            yield f"{indent}{ast.unparse(node)}\n"
