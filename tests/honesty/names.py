"""Names are free: a spec whose names are words of heun says what the spec says under names that no word contains.

Every name of a spec becomes a word of heun's own (`open`, `total`, `k`, `force`, ...), where the word is allowed; some
names of different blocks become the same word. Every command tells the same of both but for the names: JSON, key by key
and to the last bit, without a key twice; CSV line by line; the numbers of tables.

    python -m tests.honesty.names --cases 1000 [--seed 0] [--spec slider_crank]
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import re
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

from heuncli.base.errors import Finding
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.names import RESERVED_NAMES
from heuncli.scene.file_format.source import parse_source
from tests.shared.folders import SPECS
from tests.shared.in_process import run_command
from tests.shared.renamed import WORDS, NeutralSpec, neutral, tokens_for, with_words

# timed
VOLATILE = frozenset({"seconds", "sha256", "path", "file", "version", "work", "integrates", "method", "reasons"})
LONG = 12  # samples of a motion, and its tolerance: names do not hang on them
COARSE = 1e-5
STRUCK = frozenset({  # some of these share no name
    "joints", "forces", "drives", "impulses", "stops", "latches", "couplings", "rolling", "events",
})  # fmt: skip
ORDERED = re.compile(r"[\s,;:()\[\]]+")
FIGURE = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")


class Form(NamedTuple):
    """A command line behind the spec, and the form of what it writes: json, csv or text."""

    command: str
    words: tuple[str, ...]
    form: str
    file: str = ""  # what it writes in place of standard output


FORMS = (
    Form("run", ("--by-cause", "--only", "motion,points,foundation,joints,sections,forces,energy,impulses,events",
                 "--format", "json"), "json"),
    Form("run", ("--by-cause", "--format", "csv"), "csv"),
    Form("run", ("--by-cause",), "text"),
    Form("run", (), "text"),
    Form("run", ("--all", "--only", "joints,foundation,points,forces"), "text"),
    Form("run", ("--case", "all", "--format", "json"), "json"),
    Form("model", ("--format", "json"), "json"),
    Form("lagrange", ("--format", "json"), "json"),
    Form("lagrange", ("--state-space",), "text"),
    Form("balance", ("--format", "json"), "json"),
    Form("modes", ("--format", "json"), "json"),
    Form("check", ("--format", "json"), "json"),
    Form("check", ("--golden", "{folder}", "--update"), "json", "{folder}/{stem}.json"),
    Form("sweep", ("{parameter}", "--measure", "{measure}", "--format", "json"), "json"),
    Form("sweep", ("{parameter}", "--measure", "{measure}", "--format", "csv"), "csv"),
    Form("sensitivity", ("--measure", "{measure}", "--format", "json"), "json"),
    Form("plot", ("{path}", "-o", "{folder}/plot.svg"), "text"),
    Form("show", ("-o", "{folder}/show.html"), "text"),
    Form("report", ("-o", "{folder}/report.md"), "text", "{folder}/report.md"),
    Form("export", ("--body", "{body}", "--at", "first", "-q", "-o", "{folder}/loads.json"), "json",
         "{folder}/loads.json"),
)  # fmt: skip


def tree_of(path: Path) -> Any:
    """The plain data of a spec, its motion in few samples."""
    tree = parse_source(path.name, path.read_text(encoding="utf-8"), "").data
    analysis = tree.get("analysis") or {}
    if isinstance(analysis.get("samples"), int):
        analysis["samples"] = min(analysis["samples"], LONG)
    if "duration" in analysis and "method" not in analysis:
        analysis["tolerance"] = COARSE
    return json.loads(json.dumps(tree))


def words_for(spec: NeutralSpec, random: Random, merge: bool) -> dict[str, str]:
    """A word of heun's for every name, allowed in all its blocks; merge: often the same for names of other blocks."""
    taken: dict[str, set[str]] = {}
    found: dict[str, str] = {}
    for name in random.sample(sorted(spec.blocks), len(spec.blocks)):
        blocks = spec.blocks[name]
        own = blocks | ({"struck"} if blocks & STRUCK else set())
        refused = {word for block in blocks for word in RESERVED_NAMES.get(block, ())}
        refused |= {"until"} if "events" in blocks else set()
        refused |= {word for word in WORDS if is_unit(word)} if "parameters" in blocks else set()
        used = [word for word in taken if not (taken[word] & own) and word not in refused]
        free = [word for word in WORDS if word not in taken and word not in refused]
        word = random.choice(used if merge and used and random.random() < 0.6 else free or [f"{name}_"])
        taken[word] = taken.get(word, set()) | own
        found[name] = word
    return found


QUICK = tuple(form for form in FORMS if form.command in ("run", "model", "lagrange", "check", "export", "plot"))


def is_unit(word: str) -> bool:
    """Whether a word is a unit: behind a number it is read as that, and a parameter of this name is refused there."""
    try:
        return bool(parse_unit(word))
    except Finding:
        return False


class Told(NamedTuple):
    """What a command said: its exit code, what it wrote, and its errors."""

    code: int
    text: str
    errors: str


def told(form: Form, spec: Path, folder: Path, places: dict[str, str]) -> Told:
    """Run a form of a command on a spec."""
    own = {**places, "folder": str(folder), "stem": spec.stem}
    words = [word.format(**own) for word in form.words]
    done = run_command([form.command, str(spec), *words])
    text = done.stdout
    if form.file and done.returncode == 0:
        text = Path(form.file.format(**own)).read_text(encoding="utf-8")
    return Told(done.returncode, text.replace(str(folder), ""), done.stderr.replace(str(folder), ""))


def places_of(spec: NeutralSpec, names: dict[str, str], tree: Any) -> dict[str, str]:
    """What forms ask of a scene: a parameter with a value, a joint's force, a body."""
    parameters = [(name, value) for name, value in (tree.get("parameters") or {}).items()]
    name, value = next(((n, v) for n, v in parameters if isinstance(v, (int, float))), ("", ""))
    joint, body = next(iter(tree.get("joints") or {}), ""), next(iter(tree["bodies"]))
    path = f"joints.{names[joint]}.force" if joint else f"bodies.{names[body]}.center_acceleration"
    return {
        "parameter": f"{names[name]}={value!r},{value * 1.001!r}" if name else "ЖЖ=1",
        "measure": f"max {path}", "path": path, "body": names[body],
    }  # fmt: skip


def differences(spec: NeutralSpec, tree: Any, words: dict[str, str], forms: Sequence[Form]) -> Iterator[str]:
    """What two namings of a spec tell otherwise, in words; nothing if the spec is refused under either name alike."""
    tokens = tokens_for(list(words.values()))
    names = {"plain": {name: tokens[word] for name, word in words.items()}, "words": words}
    with tempfile.TemporaryDirectory() as place:
        specs = {}
        for key, own in names.items():
            folder = Path(place) / key
            folder.mkdir()
            for other in SPECS.iterdir():
                if other.suffix != ".yaml" and other.is_file():
                    (folder / other.name).symlink_to(other)
            specs[key] = folder / "scene.yaml"
            specs[key].write_text(spec.named(own), encoding="utf-8")
        for form in forms:
            a, b = (told(form, specs[key], specs[key].parent, places_of(spec, names[key], tree)) for key in names)
            a = a._replace(text=with_words(a.text, tokens), errors=with_words(a.errors, tokens))
            where = f"{form.command} {' '.join(form.words)}"
            if a.code != b.code:
                yield f"{where}: exit {a.code} became {b.code}: {b.errors.strip()[:300]}"
            elif a.code == 70:
                yield f"{where}: a bug: {b.errors.strip()[:300]}"
            elif a.code == 0:
                yield from (f"{where}: {one}" for one in compared(form.form, a.text, b.text))


def compared(form: str, a: str, b: str) -> Iterator[str]:
    """Where two texts of a form differ; the first of each."""
    if form == "json":
        try:
            one, other = (json.loads(text, object_pairs_hook=without_twins) for text in (a, b))
        except KeyError as twin:
            yield f"the key {twin} stands twice"
            return
        yield from list(in_json("", one, other))[:3]
    elif form == "csv":
        one, other = (sorted(map(tuple, csv.reader(io.StringIO(text)))) for text in (a, b))
        if [tuple(sorted(row)) for row in one] != [tuple(sorted(row)) for row in other]:
            yield next(
                (f"{x} became {y}" for x, y in zip(one, other, strict=False) if x != y),
                f"{len(one)} lines became {len(other)}",
            )
    else:
        left, right = (set(FIGURE.findall(text)) for text in (a, b))  # a table in several parts repeats some
        if left != right:
            yield f"the numbers {sorted(left - right)} became {sorted(right - left)}"


def without_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A mapping of JSON. Raises KeyError for a key that stands twice."""
    found = dict(pairs)
    if len(found) < len(pairs):
        raise KeyError(next(key for key, _ in pairs if [k for k, _ in pairs].count(key) > 1))
    return found


def in_json(path: str, a: Any, b: Any) -> Iterator[str]:
    """Where two values of JSON differ: mappings in any order, lists of words in any order."""
    if isinstance(a, dict) and isinstance(b, dict):
        if a.keys() != b.keys():
            yield f"{path}: {sorted(a.keys() - b.keys())} became {sorted(b.keys() - a.keys())}"
        for key in a.keys() & b.keys():
            if key not in VOLATILE or (isinstance(a[key], dict) and "seconds" not in a[key]):
                yield from in_json(f"{path}.{key}", a[key], b[key])
    elif isinstance(a, list) and isinstance(b, list):
        if len(a) != len(b):
            yield f"{path}: {len(a)} entries became {len(b)}"
        elif all(isinstance(one, str) for one in (*a, *b)):
            if Counter(map(sorted_words, a)) != Counter(map(sorted_words, b)):
                yield f"{path}: {a} became {b}"
        else:
            for place, (one, other) in enumerate(zip(a, b, strict=True)):
                yield from in_json(f"{path}.{place}", one, other)
    elif isinstance(a, str) and isinstance(b, str):
        if sorted_words(a) != sorted_words(b):
            yield f"{path}: {a!r} became {b!r}"
    elif a != b:
        yield f"{path}: {a!r} became {b!r}"


def sorted_words(text: str) -> tuple[str, ...]:
    """The words of a sentence: names in it are listed in their alphabet's order."""
    return tuple(sorted(ORDERED.split(text)))


def case(seed: int, stem: str, forms: Sequence[Form] = FORMS) -> list[str]:
    """What is told otherwise of a spec under the words that a seed draws."""
    tree = tree_of(SPECS / f"{stem}.yaml")
    spec, random = neutral(tree), Random(f"{stem} {seed}")
    return list(differences(spec, tree, words_for(spec, random, merge=seed % 2 == 1), forms))


def main() -> None:
    """Run cases, and print what differs."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--spec", default="")
    parser.add_argument("--quick", action="store_true", help="only run, model, lagrange, check, export and plot")
    options = parser.parse_args()
    stems = [options.spec] if options.spec else sorted(path.stem for path in SPECS.glob("*.yaml"))
    wrong = 0
    for number in range(options.cases):
        seed, stem = options.seed + number // len(stems), stems[number % len(stems)]
        found = case(seed, stem, QUICK if options.quick else FORMS)
        wrong += bool(found)
        for line in found:
            print(f"{stem} {seed}: {line}", flush=True)
    print(f"{options.cases} cases, {wrong} of them told otherwise")


if __name__ == "__main__":
    main()
