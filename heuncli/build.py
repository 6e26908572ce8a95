"""Build the package: Cython compiles the kernel into one extension module, optional by default; one wheel per platform.

The extension's source text is made from the kernel's Python files, in the build folder (kernel/one_module.py).
HEUN_KERNEL at build time:

    unset      compile; if that fails (no compiler, no Python headers, no Cython) install the plain files instead
    require    a failed compilation fails the build
    pure       compile nothing

`python -m heuncli.build` compiles in place, in a checkout. With --quick it takes half the time, for trying an
edited kernel, and the kernel's steps take a fifth longer. With --sanitize every memory access and all arithmetic
are checked at run time, for tests (tests/sanitized.py). All variants give the same bits.

A compiled kernel uses only Python's stable interface (PEP 384), so one wheel serves the oldest Python that heun runs on
and all later ones. Impure: reads HEUN_KERNEL, writes the build tree and to standard error.
"""

from __future__ import annotations

import gc
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

try:
    from setuptools import Distribution, Extension, setup
    from setuptools.command.bdist_wheel import bdist_wheel
    from setuptools.command.build_ext import build_ext
    from setuptools.command.sdist import sdist
    from setuptools.errors import CompileError
except ImportError:  # a virtual environment may contain an old version
    raise SystemExit(
        'the build needs setuptools 77 or newer and Cython: pip install -U "setuptools>=77" Cython'
    ) from None

sys.path.insert(0, str(Path(__file__).parents[1]))  # installers load this file alone, where no package can be imported
from heuncli.kernel import one_module
from heuncli.kernel.headers import PACKAGE
from heuncli.kernel.modules import NAME

FOLDER = Path("heuncli", "kernel")
# The kernel validates before it enters the loops and guards its divisors itself.
DIRECTIVES = {
    "language_level": 3,
    "boundscheck": False,
    "wraparound": False,
    "cdivision": True,
    "initializedcheck": False,
}
# No contraction to fused multiply-adds, so compiled and plain files give the same bits. No errno from sqrt: nobody
# reads it, and setting it prevents vectorization. No debugging information, which Python's own flags request: it
# takes a fifth of the build time and most of the size of a wheel, and changes no instruction.
BITS = ("-g0", "-ffp-contract=off", "-fno-math-errno")
# Short functions (operations of expressions, of one body, freedom or row) are inlined into the loops over them, but
# not so many that the loops no longer fit the processor's instruction cache.
GNU_FLAGS = ("-O3", *BITS, "--param=max-inline-insns-auto=60", "--param=inline-unit-growth=120")
QUICK_FLAGS = ("-O1", *BITS)
# Of GCC: what takes a fifth of its time at -O1 and gains the kernel nothing. -Og is as quick, its steps take four times
# as long.
QUICK_GCC_FLAGS = (*QUICK_FLAGS, "-fno-tree-dominator-opts", "-fno-tree-pta", "-fno-dse")
# Invalid memory access and undefined behaviour in C (such as NaN cast to an integer) end the process with a location.
SANITIZED_FLAGS = (
    "-O1", "-g", "-fno-omit-frame-pointer", "-ffp-contract=off", "-fno-wrapv",
    "-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all",
)  # fmt: skip
CHECKED = {"boundscheck": True, "initializedcheck": True}
MSVC_FLAGS = ("/O2", "/fp:precise")
# Messages of the build.
COMPILES = "heun: compiling the kernel; takes about a minute on two cores"
QUICKLY = "heun: compiling the kernel quickly, for trials: it runs slower than a full build"
PLAIN = (
    "heun: the kernel is not compiled ({reason}): plain Python is installed, same results, about a hundred times "
    "slower; install heun again with a C compiler and Python's headers (Debian: apt install gcc python3-dev)"
)
TERMINAL = "CONOUT$" if os.name == "nt" else "/dev/tty"
# Builds of CPython without the global lock have no stable interface yet, other Pythons none at all.
STABLE = sys.implementation.name == "cpython" and not sysconfig.get_config_var("Py_GIL_DISABLED")


def find_oldest_minor(distribution: Distribution) -> int:
    """Return the minor version of the oldest Python that the package supports.

    It is 11 or more: 3.11's stable interface is the first with buffers, which arrays need.
    """
    return int(str(distribution.python_requires).removeprefix(">=3."))  # type: ignore[attr-defined]


def add_kernel(distribution: Distribution) -> None:
    """Add the kernel extension to the distribution, unless its extensions are already set; its source is made on
    compiling.
    """
    if distribution.ext_modules is None:
        distribution.ext_modules = [Extension(f"{PACKAGE}.{NAME}", [])]


def print_to_terminal(text: str) -> None:
    """Print a line on the terminal itself, because installers swallow what a build prints; without a terminal, on
    standard error.
    """
    try:
        with Path(TERMINAL).open("w", encoding="utf-8") as terminal:
            print(text, file=terminal)
    except OSError:
        print(text, file=sys.stderr)


def is_gcc(compiler: Any) -> bool:
    """Return whether a compiler object of setuptools runs GCC, not what another compiler offers under its name."""
    command = getattr(compiler, "compiler", [])[:1]
    try:
        answer = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False).stdout
    except OSError:
        return False
    return "Free Software Foundation" in answer


class BuildKernel(build_ext):
    """build_ext with the kernel's source text and flags; it obeys HEUN_KERNEL."""

    sanitized = False
    quick = False

    def initialize_options(self) -> None:
        add_kernel(self.distribution)
        super().initialize_options()

    def finalize_options(self) -> None:
        limit = ("Py_LIMITED_API", f"0x03{find_oldest_minor(self.distribution):02X}0000")
        for extension in self.distribution.ext_modules or []:
            extension.py_limited_api = STABLE  # type: ignore[attr-defined]
            extension.define_macros = [limit] if STABLE else []
        super().finalize_options()
        self.kernel = os.environ.get("HEUN_KERNEL", "")
        if self.kernel not in ("", "require", "compiled", "pure"):
            raise SystemExit(f"HEUN_KERNEL={self.kernel}: accepted: require, compiled, pure")
        for extension in self.extensions or []:
            extension.optional = not self.is_required
        self.cython_directives = DIRECTIVES | (CHECKED if self.sanitized else {})
        self.generated = Path(self.build_temp, "generated")
        self.cython_include_dirs = [str(self.generated)]
        if self.kernel == "pure":
            self.remove_old_kernels()
            self.extensions = []

    @property
    def is_required(self) -> bool:
        """Whether a failed compilation fails the build."""
        return self.kernel in ("require", "compiled")

    def remove_old_kernels(self, exclude: str = "") -> None:
        """Delete compiled kernels that earlier builds left, except the file named `exclude`.

        An old file would be packed beside a newer source, or imported in its place: Python prefers a file for its own
        version to one for all versions, whichever is newer. Older releases compiled each kernel module to its own file.
        """
        for folder in [Path(self.build_lib) / FOLDER, *([FOLDER] if self.inplace else [])]:
            for file in folder.glob("*"):
                if file.suffix in (".so", ".pyd") and file.name != exclude:
                    file.unlink()

    def build_extension(self, ext: Extension) -> None:
        msvc = self.compiler.compiler_type == "msvc"
        quick = QUICK_GCC_FLAGS if is_gcc(self.compiler) else QUICK_FLAGS
        flags = SANITIZED_FLAGS if self.sanitized else MSVC_FLAGS if msvc else quick if self.quick else GNU_FLAGS
        ext.extra_compile_args = [*flags]
        ext.extra_link_args = [flag for flag in flags if flag.startswith("-fsanitize=")]
        self.remove_old_kernels(exclude=Path(self.get_ext_fullpath(ext.name)).name)
        print_to_terminal(QUICKLY if self.quick else COMPILES)
        self.force = True  # the flags of an existing file are unknown
        try:
            self.try_compiler(ext)
            ext.sources = [str(one_module.write_sources(FOLDER, self.generated))]
            gc.disable()  # Cython makes a tree of millions of objects, in which there is no garbage
            super().build_extension(ext)
        except Exception as reason:  # whatever stops a compiler: the plain files run everywhere
            self.remove_old_kernels()
            if self.is_required:
                raise
            print_to_terminal(PLAIN.format(reason=str(reason).strip().partition("\n")[0]))
        finally:
            gc.enable()

    def try_compiler(self, ext: Extension) -> None:
        """Compile an empty file with Python's header, before the kernel's text is made, which takes ten seconds: where
        there is no compiler, or no header, the answer comes at once. Raises CompileError.
        """
        probe = self.generated / "probe.c"
        probe.parent.mkdir(parents=True, exist_ok=True)
        probe.write_text("#include <Python.h>\n", encoding="utf-8")
        try:
            self.compiler.compile(
                [str(probe)],
                output_dir=str(self.generated),
                macros=ext.define_macros,
                include_dirs=ext.include_dirs,
                extra_preargs=ext.extra_compile_args,
            )
        except Exception as reason:
            command = [*getattr(self.compiler, "compiler", ["the C compiler"])]
            raise CompileError(f"{command[0]!r} cannot compile a file with Python.h in it") from reason

    def is_compiled(self) -> bool:
        """Whether the build tree holds the compiled kernel."""
        return bool(self.extensions) and all(Path(self.get_ext_fullpath(e.name)).exists() for e in self.extensions)


class Wheel(bdist_wheel):
    """bdist_wheel that clears earlier build output and labels the wheel by what was really compiled."""

    def initialize_options(self) -> None:
        add_kernel(self.distribution)  # an editable install runs only this command
        super().initialize_options()

    def run(self) -> None:
        if not self.skip_build:
            shutil.rmtree(self.get_finalized_command("build").build_lib, ignore_errors=True)
            self.run_command("build")
            self.skip_build = True
        kernel = self.get_finalized_command("build_ext")
        assert isinstance(kernel, BuildKernel)
        if not kernel.is_compiled():
            self.distribution.ext_modules = []
            self.root_is_pure = True
        elif STABLE:
            self.py_limited_api = f"cp3{find_oldest_minor(self.distribution)}"
        super().run()


class Source(sdist):
    """sdist that also packs the specs, the tests and the CI checks of a checkout."""

    def make_release_tree(self, base_dir: str, files: list[str]) -> None:
        paths = [path for folder in ("specs", "tests", ".ci") for path in Path(folder).rglob("*") if path.is_file()]
        extra_files = {path.as_posix() for path in paths if "__pycache__" not in path.parts}
        super().make_release_tree(base_dir, sorted({*files, *extra_files}))


def main(arguments: list[str]) -> None:
    """Compile in place; a failed compilation fails the build, unless HEUN_KERNEL says otherwise."""
    os.environ.setdefault("HEUN_KERNEL", "require")
    BuildKernel.sanitized = "--sanitize" in arguments
    BuildKernel.quick = "--quick" in arguments
    setup(script_args=["build_ext", "--inplace"])


if __name__ == "__main__":
    from heuncli import build  # setup() needs the commands of the imported module

    build.main(sys.argv[1:])
