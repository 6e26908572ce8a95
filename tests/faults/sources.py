"""What is mutated: the specs of the repository, as texts and as trees, with motions short enough for many runs."""

from __future__ import annotations

import copy
from collections.abc import Iterator, MutableMapping, MutableSequence
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

import yaml

FOLDER = Path(__file__).parents[2] / "specs"
TABLES = sorted([*FOLDER.glob("*.csv"), *FOLDER.glob("*.stl")])
LONGEST = 0.4  # seconds of motion, and
SAMPLES = 9  # instants: what a mutation breaks it breaks at once

Tree: TypeAlias = Any  # mappings, lists, numbers and words
Spot: TypeAlias = tuple[Any, Any]  # a container and a key or index in it
WORDS = {"true": True, "false": False, "null": None, "~": None}


@cache
def texts() -> dict[str, bytes]:
    """Every spec, wrong ones and tables too, as it stands in its file."""
    paths = [*sorted(FOLDER.glob("*.yaml")), *sorted((FOLDER / "broken").glob("*.yaml")), *TABLES]
    return {path.name: path.read_bytes() for path in paths}


@cache
def _trees() -> dict[str, Tree]:
    return {path.stem: shortened(parsed(path.read_text("utf-8"))) for path in sorted(FOLDER.glob("*.yaml"))}


def names() -> list[str]:
    """What the trees are called."""
    return list(_trees())


def tree(name: str) -> Tree:
    """A spec as a tree of its own that may be changed."""
    return copy.deepcopy(_trees()[name])


def parsed(text: str) -> Tree:
    """YAML 1.2 as heun reads it: `on` is a word."""
    return _valued(yaml.load(text, yaml.CBaseLoader))


def _valued(value: Tree) -> Tree:
    if isinstance(value, dict):
        return {key: _valued(v) for key, v in value.items()}
    if isinstance(value, list):
        return [_valued(v) for v in value]
    return number(value)


def number(word: str) -> Any:
    """A plain scalar's value."""
    if word in WORDS:
        return WORDS[word]
    for read in (int, float):
        try:
            return read(word)
        except ValueError:
            continue
    return word


class _Dumper(yaml.CSafeDumper):
    def ignore_aliases(self, data: Any) -> bool:
        return True  # heun reads none


def text(of: Tree) -> bytes:
    """A tree as a file."""
    written: str = yaml.dump(of, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=110)
    return written.encode("utf-8", "surrogatepass")


def tables() -> dict[str, bytes]:
    """The files that specs read tables from, by name."""
    return {path.name: texts()[path.name] for path in TABLES}


def shortened(spec: Tree) -> Tree:
    """The same for a shorter while, and without what is expected at instants."""
    analysis = spec.get("analysis", {})
    if "duration" in analysis:
        analysis["duration"] = LONGEST
        analysis["samples"] = SAMPLES
    if "times" in analysis:
        analysis["times"] = [0, LONGEST / 2, LONGEST]
    spec["expect"] = [item for item in spec.get("expect", []) if not {"at", "peak", "is"} & set(item)]
    return spec


def spots(of: Tree) -> Iterator[Spot]:
    """Every place in a tree, outer before inner."""
    if isinstance(of, MutableMapping):
        for key in of:
            yield of, key
            yield from spots(of[key])
    elif isinstance(of, MutableSequence):
        for index, value in enumerate(of):
            yield of, index
            yield from spots(value)
