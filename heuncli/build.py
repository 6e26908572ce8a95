"""How the kernel is compiled when the package is built: Cython in pure-Python mode, optional by default.

The modules stand in pyproject.toml (`tool.setuptools.ext-modules`). HEUN_KERNEL at build time:

    unset      compile; where that fails (no compiler, no Python headers, no Cython) install the plain files instead
    require    a failed compilation fails the build
    pure       compile nothing

`python -m heuncli.build` compiles in place, in a checkout. Impure: reads HEUN_KERNEL, writes the build tree.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

# The kernel validates before it enters the loops and guards its divisors itself.
DIRECTIVES = {
    "language_level": 3,
    "boundscheck": False,
    "wraparound": False,
    "cdivision": True,
    "initializedcheck": False,
}
# No contraction to fused multiply-adds, so that compiled and plain files give the same bits.
GNU_FLAGS = ("-O3", "-ffp-contract=off")
MSVC_FLAGS = ("/O2", "/fp:precise")


class BuildKernel(build_ext):
    """build_ext with the kernel's flags and the meaning of HEUN_KERNEL."""

    def finalize_options(self) -> None:
        super().finalize_options()
        self.kernel = os.environ.get("HEUN_KERNEL", "")
        if self.kernel not in ("", "require", "compiled", "pure"):
            raise SystemExit(f"HEUN_KERNEL={self.kernel}: known: require, compiled, pure")
        self.cython_directives = DIRECTIVES
        self.cython_c_in_temp = True
        if self.kernel == "pure":
            for extension in self.extensions:
                self.forget(extension)
            self.extensions = []

    def forget(self, extension: Extension) -> None:
        """Remove what an earlier build left, or it would be packed beside a newer source."""
        Path(self.get_ext_fullpath(extension.name)).unlink(missing_ok=True)

    def build_extensions(self) -> None:
        flags = MSVC_FLAGS if self.compiler.compiler_type == "msvc" else GNU_FLAGS
        for extension in self.extensions:
            extension.extra_compile_args = list(flags)
        super().build_extensions()

    def build_extension(self, ext: Extension) -> None:
        ext.optional = self.kernel not in ("require", "compiled")
        try:
            super().build_extension(ext)
        except Exception as reason:  # whatever stops a compiler: the plain files run everywhere
            if not ext.optional:
                raise
            self.forget(ext)
            print(f"heun: {ext.name} is not compiled, its plain file will run instead: {reason}", file=sys.stderr)


if __name__ == "__main__":
    setup(script_args=["build_ext", "--inplace"])
