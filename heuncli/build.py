"""How the package is built: the kernel by Cython in pure-Python mode, optional by default, one wheel for every CPython.

Its modules are those of kernel/modules.py; what C has to know of them is written from their text into the build folder
(kernel/headers.py). HEUN_KERNEL at build time:

    unset      compile; where that fails (no compiler, no Python headers, no Cython) install the plain files instead
    require    a failed compilation fails the build
    pure       compile nothing

`python -m heuncli.build` compiles in place, in a checkout; with --sanitize so that every access to memory and all
arithmetic is checked as it runs, for tests (tests/sanitized.py).

A compiled kernel asks for nothing but Python's stable interface (PEP 384), so that one wheel serves the oldest Python
that heun runs on and all that follow. Impure: reads HEUN_KERNEL, writes the build tree.
"""

from __future__ import annotations

import os
import shutil
import sys
import sysconfig
from pathlib import Path

from setuptools import Distribution, Extension, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_ext import build_ext
from setuptools.command.sdist import sdist

sys.path.insert(0, str(Path(__file__).parents[1]))  # installers load this file alone, where no package can be imported
from heuncli.kernel import headers
from heuncli.kernel.modules import MODULES
from heuncli.kernel.sources import KEEPER, digest

FOLDER = Path("heuncli", "kernel")
# The kernel validates before it enters the loops and guards its divisors itself.
DIRECTIVES = {
    "language_level": 3,
    "boundscheck": False,
    "wraparound": False,
    "cdivision": True,
    "initializedcheck": False,
}
# No contraction to fused multiply-adds, so that compiled and plain files give the same bits. No pairs of numbers as one
# vector: a struct's numbers are written one by one and read soon after, and such a read waits until all are in memory.
# No error numbers from sqrt: nobody reads them, and the call that would set one stands in the way of its loop.
# No debugging information, which Python's own flags ask for: it takes a fifth of the time and most of the room of a
# wheel, and changes no instruction.
GNU_FLAGS = ("-O3", "-g0", "-ffp-contract=off", "-fno-tree-slp-vectorize", "-fno-math-errno")
# The operations of expressions, a line or two each, go into the loop that runs them, as if C's `inline` stood there; so
# do those of one body, freedom or row into the loops over the few that a scene has.
INLINED = ("--param=max-inline-insns-auto=200",)
# Rows of numbers that stages are combined of are no structs: two of them go as one vector.
PAIRED = ("-ftree-slp-vectorize",)
SMALL = ("evaluator", "jets", "tree", "plane", "plane_rows", "closures", "orthogonal", "response")
GNU_FLAGS_OF = {"dense": PAIRED} | dict.fromkeys(SMALL, INLINED)
# What would be memory of another, or has no meaning in C (as NaN made a whole number), ends the process with its place.
SANITIZED_FLAGS = (
    "-O1", "-g", "-fno-omit-frame-pointer", "-ffp-contract=off", "-fno-wrapv",
    "-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all",
)  # fmt: skip
CHECKED = {"boundscheck": True, "initializedcheck": True}
MSVC_FLAGS = ("/O2", "/fp:precise")
# Builds of CPython without the global lock have no stable interface yet, other Pythons none at all.
STABLE = sys.implementation.name == "cpython" and not sysconfig.get_config_var("Py_GIL_DISABLED")


def oldest(distribution: Distribution) -> int:
    """The minor version of the oldest Python served; 3.11's stable interface is the first with buffers, for arrays."""
    return int(str(distribution.python_requires).removeprefix(">=3."))  # type: ignore[attr-defined]


def add_kernel(distribution: Distribution) -> None:
    """Make the kernel's modules part of what is built, unless it was decided otherwise."""
    if distribution.ext_modules is None:
        distribution.ext_modules = [
            Extension(f"heuncli.kernel.{name}", [(FOLDER / f"{name}.py").as_posix()], optional=True) for name in MODULES
        ]


class BuildKernel(build_ext):
    """build_ext with the kernel's modules, headers and flags, and the meaning of HEUN_KERNEL."""

    sanitized = False
    given_up = False  # a module could not be compiled: all of them, or none

    def initialize_options(self) -> None:
        add_kernel(self.distribution)
        super().initialize_options()

    def finalize_options(self) -> None:
        limit = ("Py_LIMITED_API", f"0x03{oldest(self.distribution):02X}0000")
        for extension in self.distribution.ext_modules or []:
            extension.py_limited_api = STABLE  # type: ignore[attr-defined]
            extension.define_macros = [limit] if STABLE else []
        super().finalize_options()
        self.kernel = os.environ.get("HEUN_KERNEL", "")
        if self.kernel not in ("", "require", "compiled", "pure"):
            raise SystemExit(f"HEUN_KERNEL={self.kernel}: known: require, compiled, pure")
        self.cython_directives = DIRECTIVES | (CHECKED if self.sanitized else {})
        self.cython_c_in_temp = True
        self.headers = Path(self.build_temp, "headers")
        self.cython_include_dirs = [str(self.headers)]
        self.folders = [Path(self.build_lib) / FOLDER]
        if self.inplace:
            self.folders.append(FOLDER)
        if self.kernel == "pure":
            for extension in self.extensions:
                self.forget(extension)
            self.extensions = []

    def forget(self, extension: Extension, but: str = "") -> None:
        """Remove what earlier builds left: it would be packed beside a newer source, or imported in its place.

        A file for one version of Python alone comes before one for all, whichever is newer.
        """
        name = extension.name.rpartition(".")[2]
        for folder in self.folders:
            for file in folder.glob(f"{name}.*"):
                if file.suffix in (".so", ".pyd") and file.name != but:
                    file.unlink()

    def build_extensions(self) -> None:
        flags: tuple[str, ...] = MSVC_FLAGS if self.compiler.compiler_type == "msvc" else GNU_FLAGS
        if self.sanitized:
            flags = SANITIZED_FLAGS
        headers.write(FOLDER, self.headers)
        for extension in self.extensions:
            more = GNU_FLAGS_OF.get(extension.name.rpartition(".")[2], ()) if flags == GNU_FLAGS else ()
            extension.extra_compile_args = [*flags, *more]
            extension.extra_link_args = [flag for flag in flags if flag.startswith("-fsanitize=")]
            extension.optional = self.kernel not in ("require", "compiled")
            self.forget(extension, but=Path(self.get_ext_fullpath(extension.name)).name)
            if extension.name.endswith(f".{KEEPER}"):
                extension.define_macros.append(("HEUN_SOURCES", digest(str(FOLDER))))
                self.forget(extension)  # whatever was edited, it holds the digest of it all
        super().build_extensions()
        if not self.is_compiled():  # compiled modules call each other as C functions: all of them, or none
            for extension in self.extensions:
                self.forget(extension)

    def is_older_than_headers(self, ext: Extension) -> bool:
        """Whether a header changed since a module was compiled: Cython looks for those beside the sources alone."""
        compiled = Path(self.get_ext_fullpath(ext.name))
        last = max(path.stat().st_mtime_ns for path in self.headers.rglob("*.pxd"))
        return not compiled.exists() or compiled.stat().st_mtime_ns < last

    def build_extension(self, ext: Extension) -> None:
        if self.given_up:  # the others would not be used
            return
        self.force = self.is_older_than_headers(ext)
        try:
            super().build_extension(ext)
        except Exception as reason:  # whatever stops a compiler: the plain files run everywhere
            if not ext.optional:
                raise
            self.given_up = True
            print(f"heun: {ext.name} is not compiled, the kernel's plain files will run: {reason}", file=sys.stderr)

    def is_compiled(self) -> bool:
        """Whether the build tree holds every module of the kernel in compiled form."""
        files = [Path(self.get_ext_fullpath(extension.name)) for extension in self.extensions]
        return bool(files) and all(file.exists() for file in files)


class Wheel(bdist_wheel):
    """bdist_wheel with nothing left from another day, labelled by what was compiled, not by what might have been."""

    def initialize_options(self) -> None:
        add_kernel(self.distribution)  # an editable install asks for this command alone
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
            self.py_limited_api = f"cp3{oldest(self.distribution)}"
        super().run()


class Source(sdist):
    """sdist with what a checkout has beyond the package: examples, tests, and the gate."""

    def make_release_tree(self, base_dir: str, files: list[str]) -> None:
        found = [path for folder in ("specs", "tests", ".ci") for path in Path(folder).rglob("*") if path.is_file()]
        more = {path.as_posix() for path in found if "__pycache__" not in path.parts}
        super().make_release_tree(base_dir, sorted({*files, *more}))


def main(words: list[str]) -> None:
    """Compile in place; a failure is one, unless HEUN_KERNEL says otherwise."""
    os.environ.setdefault("HEUN_KERNEL", "require")
    BuildKernel.sanitized = "--sanitize" in words
    setup(script_args=["build_ext", "--inplace"])


if __name__ == "__main__":
    from heuncli import build  # the module whose commands setup() takes

    build.main(sys.argv[1:])
