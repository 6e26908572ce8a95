"""The code that runs on a worker of a Dask cluster: it keeps a recipe with the scene set up, and solves variants of it.

A worker may run several tasks at a time in threads. heun's module state (suggestion counters, the time limit of a
variant) and the memory of a prepared scene serve one task only, so a lock admits one task per process and the others
wait. Parallel threads would gain little: most of a variant is Python code, which runs in one thread at a time. No
signal reaches a thread, so only the loops that check the clock enforce the time limit of a variant. Impure: the clock,
and what this process keeps.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator, Sequence
from typing import Any

from heuncli.analyses.variants.evaluation import Recipe, VariantEvaluator
from heuncli.analyses.variants.measures import VariantResult
from heuncli.analyses.variants.parameters import Values
from heuncli.app.cli.variant_workers import solve_contained
from heuncli.base.files import PACKAGE_FOLDER
from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.form import KERNEL
from heuncli.scene.file_format.named_files import FileNotPreloaded
from heuncli.version import VERSION

Variant = tuple[int, Values]  # its number in the plan, and its values
PACKAGE = os.path.abspath(PACKAGE_FOLDER)  # noqa: PTH100
_TASK_LOCK = threading.Lock()


class WorkerVersion(NamedTuple):
    """The version of heun on a worker: the digest of its source text, and its kernel."""

    text: str
    kernel: str


class PartialResults(NamedTuple):
    """The results of the first variants of a batch, and the time they took [s].

    missing_file: the file that the next variant names and the recipe does not contain
    failure: why this worker cannot solve anything
    """

    results: tuple[VariantResult, ...] = ()
    seconds: float = 0.0
    missing_file: str = ""
    failure: str = ""


# The first request to a worker, as text: without heun there, none of its functions could be sent.
HELLO = (
    "(lambda load: (lambda version: (version, "
    f"load({__name__!r}).read_worker_version() if version == {VERSION!r} else None))(load('heuncli.version').VERSION)"
    ")(__import__('importlib').import_module)"
)


def read_worker_version() -> WorkerVersion:
    """Return the version of heun in this process."""
    return WorkerVersion(text_digest(), KERNEL)


def text_digest() -> str:
    """Compute a digest of heun's source text, in 20 ms.

    Two workers with the same text give the same results; with the same version number the text may still differ during
    development.
    """
    import hashlib

    text = hashlib.sha256()
    for path in sorted(_iter_sources()):
        with open(os.path.join(PACKAGE, path), "rb") as file:  # noqa: PTH118, PTH123 - as below
            content = file.read().replace(b"\r\n", b"\n")
        text.update(f"{path} {len(content)}\n".encode())
        text.update(content)
    return text.hexdigest()


def _iter_sources() -> Iterator[str]:
    """Yield the Python files of the package, relative to it, with / as separator."""
    for folder, _, names in os.walk(PACKAGE):
        relative = os.path.relpath(folder, PACKAGE).replace(os.sep, "/")
        yield from (f"{relative}/{name}" for name in names if name.endswith(".py"))


class CachedRecipe:
    """A recipe in the memory of a worker, with its scene set up on first use; pickled without the scene."""

    def __init__(self, recipe: Recipe) -> None:
        self.recipe = recipe
        self._evaluator: VariantEvaluator | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return CachedRecipe, (self.recipe,)

    def __dask_tokenize__(self) -> tuple[str, int]:
        return "heun", id(self)

    def solve_variants(self, variants: Sequence[Variant], seconds: float) -> PartialResults:
        """Solve variants one after the other, until all are done or the time is used up."""
        with _TASK_LOCK:
            start = time.monotonic()
            results: list[VariantResult] = []
            missing_file = ""
            try:
                evaluator = self._evaluator = self._evaluator or VariantEvaluator(self.recipe)
                for _, values in variants:
                    results.append(solve_contained(evaluator, values, "sweep", self.recipe.options.time_limit))
                    if time.monotonic() - start > seconds:
                        break
            except FileNotPreloaded as missing:
                missing_file = missing.name
            return PartialResults(tuple(results), time.monotonic() - start, missing_file)


def solve_batch(recipe: CachedRecipe, variants: Sequence[Variant], seconds: float) -> PartialResults:
    """Run the task of a worker, CachedRecipe.solve_variants; exceptions become text, because Dask cannot send all of
    them.
    """
    try:
        return recipe.solve_variants(variants, seconds)
    except Exception as error:
        return PartialResults(failure=format_exception(error))


def format_exception(error: BaseException | None) -> str:
    """Format an exception on one line."""
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
