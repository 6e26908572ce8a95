"""What a worker of a Dask cluster does: it keeps a recipe with the scene set up, and answers variants of it.

A worker runs its tasks in threads, several at a time where it was started so. What heun keeps in its modules (how many
suggestions are still looked for, until when a variant may take) is that of one piece of work at a time, and so is what
one scene has set up: here one task of a process works, the others wait for it. Their threads would gain little: most of
a variant is Python, which runs in one thread at a time anyway. No signal reaches a thread: that a variant has a limit
of time is seen to by the loops that look at the clock. Impure: the clock, and what this process keeps.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import heuncli
from heuncli.analyses.variants.asking import Answer, Asker, Recipe
from heuncli.app.commands.sweep.workers import answer_of
from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.form import KERNEL
from heuncli.scene.file_format.named_files import FileNotKept
from heuncli.version import VERSION

Variant = tuple[int, Mapping[str, str]]  # its number in the plan, and its values in the form of `--set`
PACKAGE = os.path.dirname(os.path.abspath(heuncli.__file__))  # noqa: PTH100, PTH120
_AT_WORK = threading.Lock()


class AbleWorker(NamedTuple):
    """What a worker has: the digest of heun's text, and the kernel that runs."""

    text: str
    kernel: str


class PartAnswered(NamedTuple):
    """The answers of the first variants of a batch, and what they took [s].

    lacking: the file that the next one names, where the recipe has it not; broken: why this worker answers nothing.
    """

    answers: tuple[Answer, ...] = ()
    seconds: float = 0.0
    lacking: str = ""
    broken: str = ""


# What a worker is asked first, as text: with no heun there, no function of it could be sent.
HELLO = (
    "(lambda load: (lambda version: (version, "
    f"load({__name__!r}).described() if version == {VERSION!r} else None))(load('heuncli.version').VERSION)"
    ")(__import__('importlib').import_module)"
)


def described() -> AbleWorker:
    """What this process has."""
    return AbleWorker(text_digest(), KERNEL)


def text_digest() -> str:
    """A digest of the text of heun; 20 ms. Two that are alike answer alike, where a version alone may be under way."""
    import hashlib

    text = hashlib.sha256()
    for path in sorted(_sources()):
        with open(os.path.join(PACKAGE, path), "rb") as file:  # noqa: PTH118, PTH123 - as below
            content = file.read().replace(b"\r\n", b"\n")
        text.update(f"{path} {len(content)}\n".encode())
        text.update(content)
    return text.hexdigest()


def _sources() -> Iterator[str]:
    """The files of Python in the package, relative to it, with / between the parts."""
    for folder, _, names in os.walk(PACKAGE):
        inner = os.path.relpath(folder, PACKAGE).replace(os.sep, "/")
        yield from (f"{inner}/{name}" for name in names if name.endswith(".py"))


class HeldRecipe:
    """A recipe in the memory of a worker, with its scene set up once it is asked for; sent on, the recipe alone."""

    def __init__(self, recipe: Recipe) -> None:
        self.recipe = recipe
        self._asker: Asker | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return HeldRecipe, (self.recipe,)

    def __dask_tokenize__(self) -> tuple[str, int]:
        return "heun", id(self)

    def answered(self, variants: Sequence[Variant], seconds: float) -> PartAnswered:
        """The answers of variants one after the other, until they are done or have taken so long."""
        with _AT_WORK:
            begun = time.monotonic()
            answers: list[Answer] = []
            lacking = ""
            try:
                asker = self._asker = self._asker or Asker(self.recipe)
                for _, values in variants:
                    answers.append(answer_of(asker, values))
                    if time.monotonic() - begun > seconds:
                        break
            except FileNotKept as missing:
                lacking = missing.name
            return PartAnswered(tuple(answers), time.monotonic() - begun, lacking)


def answered(held: HeldRecipe, variants: Sequence[Variant], seconds: float) -> PartAnswered:
    """The task of a worker: see HeldRecipe.answered. What is raised is told in words: Dask cannot send all of it."""
    try:
        return held.answered(variants, seconds)
    except Exception as error:
        return PartAnswered(broken=in_words(error))


def in_words(error: BaseException | None) -> str:
    """An exception on a line."""
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
