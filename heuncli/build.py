"""How the package is built: the kernel by Cython, one extension module, optional by default; one wheel a platform.

Its text is made of the kernel's Python files in the build folder (kernel/one_module.py). HEUN_KERNEL at build time:

    unset      compile; where that fails (no compiler, no Python headers, no Cython) install the plain files instead
    require    a failed compilation fails the build
    pure       compile nothing

`python -m heuncli.build` compiles in place, in a checkout; with --quick in a third of the time, for a kernel that is
edited and tried and runs slower; with --sanitize so that every access to memory and all arithmetic is checked as it
runs, for tests (tests/sanitized.py). All give the same bits.

A compiled kernel asks for nothing but Python's stable interface (PEP 384), so that one wheel serves the oldest Python
that heun runs on and all that follow. Impure: reads HEUN_KERNEL, writes the build tree and to standard error.
"""

from __future__ import annotations

import gc
import os
import shutil
import sys
import sysconfig
from pathlib import Path

try:
    from setuptools import Distribution, Extension, setup
    from setuptools.command.bdist_wheel import bdist_wheel
    from setuptools.command.build_ext import build_ext
    from setuptools.command.sdist import sdist
except ImportError:  # a virtual environment may bring one that is too old
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
# No contraction to fused multiply-adds, so compiled and plain files give the same bits. No error numbers from sqrt:
# nobody reads them, and the call that would set one stands in the way of its loop. No debugging information, which
# Python's own flags ask for: it takes a fifth of the time and most of the room of a wheel, and changes no instruction.
BITS = ("-g0", "-ffp-contract=off", "-fno-math-errno")
# The operations of expressions, of one body, freedom or row, a line or two each, go into the loops over them, not so
# many that the loops no longer fit the processor's memory for instructions.
GNU_FLAGS = ("-O3", *BITS, "--param=max-inline-insns-auto=60", "--param=inline-unit-growth=120")
QUICK_FLAGS = ("-O1", *BITS)
# What would be memory of another, or has no meaning in C (as NaN made a whole number), ends the process with its place.
SANITIZED_FLAGS = (
    "-O1", "-g", "-fno-omit-frame-pointer", "-ffp-contract=off", "-fno-wrapv",
    "-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all",
)  # fmt: skip
CHECKED = {"boundscheck": True, "initializedcheck": True}
MSVC_FLAGS = ("/O2", "/fp:precise")
# What is said while it builds.
COMPILES = "heun: the kernel is compiled, which takes about a minute on two cores"
QUICKLY = "heun: the kernel is compiled quickly, to be tried: it runs slower than it can"
PLAIN = (
    "heun: the kernel is not compiled ({reason}): plain Python is installed, with the same numbers some hundred times "
    "slower; with a C compiler and Python's headers (Debian: apt install gcc python3-dev) install heun again"
)
TERMINAL = "CONOUT$" if os.name == "nt" else "/dev/tty"
# Builds of CPython without the global lock have no stable interface yet, other Pythons none at all.
STABLE = sys.implementation.name == "cpython" and not sysconfig.get_config_var("Py_GIL_DISABLED")


def oldest(distribution: Distribution) -> int:
    """The minor version of the oldest Python served; 3.11's stable interface is the first with buffers, for arrays."""
    return int(str(distribution.python_requires).removeprefix(">=3."))  # type: ignore[attr-defined]


def add_kernel(distribution: Distribution) -> None:
    """Make the kernel part of what is built, unless it was decided otherwise; its text is made when it is compiled."""
    if distribution.ext_modules is None:
        distribution.ext_modules = [Extension(f"{PACKAGE}.{NAME}", [])]


def say(text: str) -> None:
    """A line for who waits: on the terminal itself, for what a build prints installers keep to themselves."""
    try:
        with Path(TERMINAL).open("w", encoding="utf-8") as terminal:
            print(text, file=terminal)
    except OSError:
        print(text, file=sys.stderr)


class BuildKernel(build_ext):
    """build_ext with the kernel's text and flags, and the meaning of HEUN_KERNEL."""

    sanitized = False
    quick = False

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
        for extension in self.extensions or []:
            extension.optional = not self.is_required
        self.cython_directives = DIRECTIVES | (CHECKED if self.sanitized else {})
        self.generated = Path(self.build_temp, "generated")
        self.cython_include_dirs = [str(self.generated)]
        if self.kernel == "pure":
            self.forget()
            self.extensions = []

    @property
    def is_required(self) -> bool:
        """Whether a failed compilation fails the build."""
        return self.kernel in ("require", "compiled")

    def forget(self, but: str = "") -> None:
        """Remove what earlier builds left: it would be packed beside a newer source, or imported in its place.

        A file for one version of Python alone comes before one for all, whichever is newer; and once each of the
        kernel's modules was compiled by itself.
        """
        for folder in [Path(self.build_lib) / FOLDER, *([FOLDER] if self.inplace else [])]:
            for file in folder.glob("*"):
                if file.suffix in (".so", ".pyd") and file.name != but:
                    file.unlink()

    def build_extension(self, ext: Extension) -> None:
        msvc = self.compiler.compiler_type == "msvc"
        flags = SANITIZED_FLAGS if self.sanitized else MSVC_FLAGS if msvc else QUICK_FLAGS if self.quick else GNU_FLAGS
        ext.extra_compile_args = [*flags]
        ext.extra_link_args = [flag for flag in flags if flag.startswith("-fsanitize=")]
        self.forget(but=Path(self.get_ext_fullpath(ext.name)).name)
        say(QUICKLY if self.quick else COMPILES)
        self.force = True  # whether what lies there was made with these flags nobody knows
        try:
            ext.sources = [str(one_module.write(FOLDER, self.generated))]
            gc.disable()  # Cython makes a tree of millions of objects, in which there is no garbage
            super().build_extension(ext)
        except Exception as reason:  # whatever stops a compiler: the plain files run everywhere
            self.forget()
            if self.is_required:
                raise
            say(PLAIN.format(reason=str(reason).strip().partition("\n")[0]))
        finally:
            gc.enable()

    def is_compiled(self) -> bool:
        """Whether the build tree holds the compiled kernel."""
        return bool(self.extensions) and all(Path(self.get_ext_fullpath(e.name)).exists() for e in self.extensions)


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
    BuildKernel.quick = "--quick" in words
    setup(script_args=["build_ext", "--inplace"])


if __name__ == "__main__":
    from heuncli import build  # the module whose commands setup() takes

    build.main(sys.argv[1:])
