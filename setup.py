"""The kernel's modules as extensions. How they are compiled: heuncli/build.py; all else: pyproject.toml."""

from pathlib import Path
from runpy import run_path

from setuptools import Extension, setup

KERNEL = Path("heuncli", "kernel")
NAMES = run_path(str(Path(__file__).parent / KERNEL / "modules.py"))["MODULES"]

setup(ext_modules=[Extension(f"heuncli.kernel.{name}", [(KERNEL / f"{name}.py").as_posix()]) for name in NAMES])
