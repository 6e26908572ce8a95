"""The text of the kernel's one extension module, made of its Python files where it is compiled, and committed nowhere.

    compiled.pxd    what has to be known before any function: enumerations, structs, extension types (headers.py)
    compiled.pyx    C's library, constants, functions that are inlined where they are used; then an `include` a module
    NAME.pxi        the module NAME.py line for line, so that errors name the right line: without its imports, with the
                    heads of C functions and extension types as Cython has them. All else stays as it is written

Everything of the kernel is in one name space there, so a name has one meaning in all of its modules.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator
from pathlib import Path

from heuncli.kernel import headers
from heuncli.kernel.headers import PACKAGE
from heuncli.kernel.modules import DECLARED, MODULES, NAME
from heuncli.kernel.sources import digest_code, digest_texts, read

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
OWN = ("TEXT_DIGEST", "CODE_DIGESTS", "cython")  # names that compose() gives


class DuplicateName(Exception):
    """A name has two meanings in the kernel."""


def write(folder: Path, to: Path) -> Path:
    """Write the text for the kernel's files in a folder into another, below their package; the path of the .pyx.

    What says the same stays as it is, with its time. Raises DuplicateName.
    """
    package = to.joinpath(*PACKAGE.split("."))
    package.mkdir(parents=True, exist_ok=True)
    modules = parse(folder)
    refuse_duplicates(modules)
    structs = headers.known_structs(modules)
    texts = {f"{name}.pxi": include(read(str(folder), name), modules[name], structs) for name in MODULES}
    texts |= {f"{NAME}.pxd": headers.declare(modules), f"{NAME}.pyx": compose(folder, modules)}
    texts |= {"__init__.pxd": "", "../__init__.pxd": ""}
    for name, text in texts.items():
        path = package / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    return package / f"{NAME}.pyx"


def parse(folder: Path) -> dict[str, ast.Module]:
    """All modules of the kernel by their names, those first that only declare."""
    return {name: ast.parse(read(str(folder), name)) for name in (*DECLARED, *MODULES)}


def compose(folder: Path, modules: dict[str, ast.Module]) -> str:
    """The text of the .pyx."""
    blocks = {name: headers.plain_block(module) for name, module in modules.items() if name in MODULES}
    library = sorted({name for block in blocks.values() for name in headers.library(block)})
    taken = {ast.unparse(node) for name in MODULES for node in modules[name].body if is_import(node)}
    numbers = [pair for name in MODULES for pair in headers.floats(modules[name])]
    structs = headers.known_structs(modules)
    inlined = [text for name in DECLARED for text in headers.inlined_functions(modules[name], structs)]
    parts = [
        FIRST,
        f"from libc.math cimport {', '.join(library)}\n",
        "".join(f"{line}\n" for line in sorted(taken)),
        f'TEXT_DIGEST = "{digest_texts(str(folder))}"\nCODE_DIGESTS = {digest_code(str(folder))}\n',
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
    """Raises DuplicateName where a name of the kernel is defined twice, or is one of Python's own or of C's library."""
    blocks = [headers.plain_block(module) for name, module in modules.items() if name in MODULES]
    places = dict.fromkeys(dir(builtins), "Python itself") | dict.fromkeys(OWN, "one_module.py")
    places |= {name: "C's library" for block in blocks for name in headers.library(block)}
    wrong = []
    for module, name, line in defined_names(modules):
        place = f"{module}.py:{line}"
        if name in places:
            wrong.append(f"{name} is in {places[name]} and in {place}")
        places.setdefault(name, place)
    if wrong:
        raise DuplicateName(f"the kernel is compiled as one module, where a name has one meaning: {'; '.join(wrong)}")


def defined_names(modules: dict[str, ast.Module]) -> Iterator[tuple[str, str, int]]:
    """Module, name and line of all that is defined at the top of modules, or in their blocks for plain Python."""
    for module, text in modules.items():
        for node in (*text.body, *([] if module in DECLARED else headers.plain_block(text))):
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                yield module, node.name, node.lineno
            elif isinstance(node, ast.Assign):
                for part in ast.walk(node.targets[0]):
                    if isinstance(part, ast.Name):
                        yield module, part.id, node.lineno
