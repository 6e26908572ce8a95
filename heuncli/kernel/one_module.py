"""Generate the kernel's one extension module from its Python files when it is compiled; the text is never committed.

    compiled.pxd    what must be known before any function: enumerations, structs, extension types (headers.py)
    compiled.pyx    C's library, constants, functions that are inlined where they are used; then an `include` a module
    NAME.pxi        the module NAME.py line for line, so that errors name the right line: without its imports, with the
                    heads of C functions and extension types in Cython's form. All else stays as it is written

The whole kernel is one name space there, so a name has one meaning in all of its modules.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator
from pathlib import Path

from heuncli.kernel import headers
from heuncli.kernel.headers import PACKAGE
from heuncli.kernel.modules import DECLARED, MODULES, NAME, digest_code, digest_texts, read_module

HEADER = """\
# Made of heuncli/kernel/*.py by one_module.py.
from __future__ import annotations

import cython
"""
# Numbers that C knows while it compiles.
NUMBERS = '''cdef extern from *:
    """
{given}    """
{known}
'''
GENERATED_NAMES = ("TEXT_DIGEST", "CODE_DIGESTS", "cython")  # names that compose() gives


class DuplicateName(Exception):
    """A name has two meanings in the kernel."""


def write_sources(folder: Path, target: Path) -> Path:
    """Write the Cython text of a kernel folder below another folder, in their package; return the path of the .pyx.

    Files whose text does not change keep their time. Raises DuplicateName.
    """
    package = target.joinpath(*PACKAGE.split("."))
    package.mkdir(parents=True, exist_ok=True)
    modules = parse_modules(folder)
    refuse_duplicates(modules)
    structs = headers.find_struct_names(modules)
    texts = {f"{name}.pxi": convert_module(read_module(str(folder), name), modules[name], structs) for name in MODULES}
    texts |= {f"{NAME}.pxd": headers.generate_declarations(modules), f"{NAME}.pyx": compose(folder, modules)}
    texts |= {"__init__.pxd": "", "../__init__.pxd": ""}
    for name, text in texts.items():
        path = package / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    return package / f"{NAME}.pyx"


def parse_modules(folder: Path) -> dict[str, ast.Module]:
    """Parse all modules of the kernel by name; those that only declare come first."""
    return {name: ast.parse(read_module(str(folder), name)) for name in (*DECLARED, *MODULES)}


def compose(folder: Path, modules: dict[str, ast.Module]) -> str:
    """Return the text of the .pyx."""
    library = sorted({library_name for name in MODULES for library_name in headers.find_library_names(modules[name])})
    imports = {ast.unparse(node) for name in MODULES for node in modules[name].body if is_import(node)}
    numbers = [pair for name in MODULES for pair in headers.find_float_constants(modules[name])]
    structs = headers.find_struct_names(modules)
    inline_functions = [text for name in DECLARED for text in headers.generate_inline_functions(modules[name], structs)]
    parts = [
        HEADER,
        f"from libc.math cimport {', '.join(library)}\n",
        "".join(f"{line}\n" for line in sorted(imports)),
        f'TEXT_DIGEST = "{digest_texts(str(folder))}"\nCODE_DIGESTS = {digest_code(str(folder))}\n',
        NUMBERS.format(
            given="".join(f"    static const double heun_{name} = {number!r};\n" for name, number in numbers),
            known="\n".join(f'    const double {name} "heun_{name}"' for name, _ in numbers),
        ),
        *inline_functions,
        "".join(f'include "{name}.pxi"\n' for name in MODULES),
    ]
    return "\n".join(parts)


def is_import(node: ast.stmt) -> bool:
    """Return whether a statement imports what the compiled kernel needs from Python."""
    if isinstance(node, ast.ImportFrom):
        return node.module not in ("__future__", "math") and not str(node.module).startswith(f"{PACKAGE}.")
    return isinstance(node, ast.Import)


def convert_module(text: str, module: ast.Module, structs: frozenset[str]) -> str:
    """Return a module's text in the form that the .pyx includes, line for line."""
    lines = text.splitlines()
    for node in module.body:
        is_number = headers.is_float_constant(node) or headers.is_integer_constant(node)
        if is_number or isinstance(node, (ast.Import, ast.ImportFrom)):
            clear_lines(lines, node.lineno, node.end_lineno or node.lineno)
        elif isinstance(node, ast.FunctionDef):
            rewrite_head(lines, node, structs)
        elif isinstance(node, ast.ClassDef):
            lines[node.lineno - 1] = f"cdef class {node.name}:"
            for method in node.body:
                if isinstance(method, ast.FunctionDef):
                    rewrite_head(lines, method, structs)
    return "\n".join(lines) + "\n"


def rewrite_head(lines: list[str], node: ast.FunctionDef, structs: frozenset[str]) -> None:
    """Write the head of a C function in Cython's form on its first line; leave other functions unchanged."""
    for signature in headers.generate_signature(node, structs):
        clear_lines(lines, node.lineno, node.body[0].lineno - 1)
        lines[node.lineno - 1] = f"{' ' * node.col_offset}{signature}:"


def clear_lines(lines: list[str], first: int, last: int) -> None:
    """Empty some lines; the first of a file is 1."""
    lines[first - 1 : last] = [""] * (last - first + 1)


# Names


def refuse_duplicates(modules: dict[str, ast.Module]) -> None:
    """Raises DuplicateName if a name of the kernel is defined twice, or is one of Python's own or of C's library."""
    places = dict.fromkeys(dir(builtins), "Python itself") | dict.fromkeys(GENERATED_NAMES, "one_module.py")
    places |= {name: "C's library" for module in MODULES for name in headers.find_library_names(modules[module])}
    wrong = []
    for module, name, line in iter_defined_names(modules):
        place = f"{module}.py:{line}"
        if name in places:
            wrong.append(f"{name} is in {places[name]} and in {place}")
        places.setdefault(name, place)
    if wrong:
        raise DuplicateName(f"the kernel is compiled as one module, where a name has one meaning: {'; '.join(wrong)}")


def iter_defined_names(modules: dict[str, ast.Module]) -> Iterator[tuple[str, str, int]]:
    """Yield module, name and line of all that is defined at the top of modules."""
    for module, text in modules.items():
        for node in text.body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                yield module, node.name, node.lineno
            elif isinstance(node, ast.Assign):
                for part in ast.walk(node.targets[0]):
                    if isinstance(part, ast.Name):
                        yield module, part.id, node.lineno
