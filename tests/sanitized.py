"""The kernel's tests once more, with every access to memory and all arithmetic checked as it runs.

    python -m tests.sanitized                          # builds the kernel so, in build/sanitized; then the tests below
    python -m tests.sanitized tests/closed_forms -x    # or others, with pytest's options; some ten times slower

Indices into arrays are checked by Cython, what lies behind pointers by the compiler's sanitizers (GCC or Clang on
Linux); the first fault ends the process with its place. Python's own small blocks would hide what is written just
beside an array: each comes from the system instead.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

CHECKOUT = Path(__file__).parents[1]
COPY = CHECKOUT / "build" / "sanitized"
LINKED = ("tests", "specs", "README.md", "pyproject.toml", ".ci")
TESTS = (
    "tests/package/test_kernels_agree.py",
    "tests/package/test_kernel_choice.py",
    "tests/spec/test_program.py",
    "tests/spec/test_held.py",
    "tests/spec/test_enclosure.py",
    "tests/spec/test_integrals.py",
    "tests/spec/test_curves.py",
    "tests/laws/test_duals.py",
    "tests/cli/test_specs.py",
)


def copy() -> None:
    """The sources of this checkout, to be compiled otherwise; what was compiled there from the same text stays."""
    compiled = shutil.ignore_patterns("*.so", "*.pyd", "__pycache__")
    shutil.copytree(CHECKOUT / "heuncli", COPY / "heuncli", dirs_exist_ok=True, ignore=compiled, copy_function=renew)
    for path in (COPY / "heuncli").rglob("*"):  # what is no more
        if (
            path.is_file()
            and path.suffix not in (".so", ".pyd", ".pyc")
            and not (CHECKOUT / path.relative_to(COPY)).exists()
        ):
            path.unlink()
    for name in LINKED:
        if not (COPY / name).is_symlink():
            (COPY / name).symlink_to(CHECKOUT / name)


def renew(source: str, target: str) -> None:
    """Copy a file whose text is another; its time is now, so that it is compiled again, whichever was older."""
    if not Path(target).exists() or Path(target).read_bytes() != Path(source).read_bytes():
        shutil.copyfile(source, target)


def library(name: str) -> str:
    """The path of a sanitizer's library, as the compiler knows it."""
    compiler = os.environ.get("CC", "cc")
    found = subprocess.run([compiler, f"-print-file-name={name}"], capture_output=True, text=True, check=True)
    return found.stdout.strip()


def environment() -> dict[str, str]:
    """Of a Python that runs sanitized modules."""
    return os.environ | {
        "PYTHONPATH": str(COPY),
        "HEUN_KERNEL": "require",
        "LD_PRELOAD": f"{library('libasan.so')} {library('libubsan.so')}",
        "PYTHONMALLOC": "malloc",
        "ASAN_OPTIONS": "detect_leaks=0",  # Python keeps much to its end
        "UBSAN_OPTIONS": "print_stacktrace=1",
        "OPENBLAS_NUM_THREADS": "1",
    }


def main(words: list[str]) -> int:
    copy()
    plain = {key: value for key, value in os.environ.items() if key != "HEUN_KERNEL"} | {"PYTHONPATH": str(COPY)}
    built = subprocess.run(
        [sys.executable, "-m", "heuncli.build", "--sanitize"], cwd=COPY, env=plain, capture_output=True, text=True
    )
    if built.returncode:
        print(built.stdout + built.stderr, file=sys.stderr)
        return built.returncode
    # --capture=sys: what a sanitizer says as it ends the process is seen
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--capture=sys", *(words or TESTS)]
    return subprocess.run(command, cwd=COPY, env=environment()).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
