"""The text of the kernel's one extension module, made of its Python files where it is compiled, and committed nowhere.

    compiled.pxd    what has to be known before any function: enumerations, structs, extension types (headers.py)
    compiled.pyx    C's library, constants, the functions that are inlined where they are used; then an `include` a module
    NAME.pxi        the module NAME.py line for line, so that errors name the right line: without its imports, with the
                    heads of C functions and extension types as Cython has them. All else stays as it is written

Everything of the kernel is in one name space there, so a name has one meaning in all of its modules.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from heuncli.kernel import headers
from heuncli.kernel.headers import PACKAGE
from heuncli.kernel.modules import DECLARED, MODULES, NAME
from heuncli.kernel.sources import digest_code, digest_texts

FIRST = """\
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


class DuplicateName(Exception):
    """A name has two meanings in the kernel."""


def write(folder: Path, to: Path) -> Path:
    """Write the text for the kernel's files in a folder into another, below their package; the path of the .pyx.

    What says the same stays as it is, with its time. Raises DuplicateName.
    """
    package = to.joinpath(*PACKAGE.split("."))
    package.mkdir(parents=True, exist_ok=True)
    modules = {name: ast.parse(read(folder, name)) for name in (*DECLARED, *MODULES)}
    refuse_duplicates(modules)
    texts = {f"{name}.pxi": include(read(folder, name), modules[name], headers.known_structs(folder)) for name in MODULES}
    texts |= {f"{NAME}.pxd": headers.declare(folder, modules), f"{NAME}.pyx": compose(folder, modules)}
    texts |= {"__init__.pxd": "", "../__init__.pxd": ""}
    for name, text in texts.items():
        path = package / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    return package / f"{NAME}.pyx"


def read(folder: Path, name: str) -> str:
    """The text of a module."""
    return (folder / f"{name}.py").read_text(encoding="utf-8")


def compose(folder: Path, modules: dict[str, ast.Module]) -> str:
    """The text of the .pyx."""
    blocks = {name: headers.plain_block(module) for name, module in modules.items() if name in MODULES}
    library = {name for block in blocks.values() for name in headers.library(block)}
    taken = {ast.unparse(node) for name in MODULES for node in modules[name].body if is_import(node)}
    numbers = [pair for name in MODULES for pair in headers.floats(modules[name])]
    structs = headers.known_structs(folder)
    inlined = [text for name in DECLARED for text in headers.inlined_functions(modules[name], structs)]
    parts = [
        FIRST,
        f"from libc.math cimport {', '.join(sorted(library))}\n",
        "".join(f"{line}\n" for line in sorted(taken)),
        f'SOURCES = "{digest_texts(str(folder))}"\nCODES = {digest_code(str(folder))}\n',
        NUMBERS.format(
            given="".join(f"    static const double heun_{name} = {number!r};\n" for name, number in numbers),
            known="\n".join(f'    const double {name} "heun_{name}"' for name, _ in numbers),
        ),
        *inlined,
        "".join(f'include "{name}.pxi"\n' for name in MODULES),
    ]
    return "\n".join(parts)


def is_import(node: ast.stmt) -> bool:
    """Whether a statement imports what the compiled kernel needs of Python."""
    return isinstance(node, ast.Import) or (isinstance(node, ast.ImportFrom) and node.module != "__future__")


def include(text: str, module: ast.Module, structs: frozenset[str]) -> str:
    """A module's text as the .pyx includes it, line for line."""
    lines = text.splitlines()
    for node in module.body:
        if isinstance(node, (ast.Import, ast.ImportFrom, ast.Try, ast.If)) or headers.is_float(node):
            blank(lines, node.lineno, node.end_lineno or node.lineno)
        elif isinstance(node, ast.FunctionDef):
            rewrite_head(lines, node, structs)
        elif isinstance(node, ast.ClassDef):
            lines[node.lineno - 1] = f"cdef class {node.name}:"
            for method in node.body:
                if isinstance(method, ast.FunctionDef):
                    rewrite_head(lines, method, structs)
    return "\n".join(lines) + "\n"


def rewrite_head(lines: list[str], node: ast.FunctionDef, structs: frozenset[str]) -> None:
    """The head of a C function as Cython has it, on its first line; other functions stay as they are."""
    for signature in headers.signature(node, structs):
        blank(lines, node.lineno, node.body[0].lineno - 1)
        lines[node.lineno - 1] = f"{' ' * node.col_offset}{signature}:"


def blank(lines: list[str], first: int, last: int) -> None:
    """Empty lines, the first of a file being 1."""
    lines[first - 1 : last] = [""] * (last - first + 1)


# Names


def refuse_duplicates(modules: dict[str, ast.Module]) -> None:
    """Raises DuplicateName where two modules, or two places of one, define the same name."""
    places: dict[str, str] = {}
    wrong = []
    for module, name, line in defined_names(modules):
        place = f"{module}.py:{line}"
        if name in places:
            wrong.append(f"{name}: {places[name]} and {place}")
        places.setdefault(name, place)
    if wrong:
        raise DuplicateName(f"a name has one meaning in the whole kernel, which is compiled as one module; {'; '.join(wrong)}")


def defined_names(modules: dict[str, ast.Module]) -> Iterator[tuple[str, str, int]]:
    """Module, name and line of all that is defined at the top of modules, or in their blocks for plain Python."""
    for module, text in modules.items():
        block = [] if module in DECLARED else headers.plain_block(text)
        for node in (*text.body, *block):
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                yield module, node.name, node.lineno
            elif isinstance(node, ast.Assign):
                for target in node.targets:
                    for part in ast.walk(target):
                        if isinstance(part, ast.Name):
                            yield module, part.id, node.lineno
