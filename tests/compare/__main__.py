"""Compare all numbers and all words of two heuns: record what one says of many scenes, then tell what differs.

    python -m tests.compare record OUT.json.gz [--quick] [--scenes FILE] [--jobs 2] [--root CHECKOUT]
    python -m tests.compare diff OLD.json.gz NEW.json.gz [--bits] [--noise] [--ignore REGEX]... [--most 200]

`record` runs the heuncli this interpreter imports, through its command's door, in forked workers: specs/*.yaml,
specs/broken/*.yaml and tests/bench/scenes/*.yaml of the checkout, and the scenes of FILE, which harvest.py writes (a gz
of JSON: a list of {name, text, files: {name: text}, words: [options of `run`]}). One JSON line a scene in the gz file.
Needs the standard library and numpy only. Left out as volatile: work.seconds, version, spec (path and sha256), the
version in headings.

`diff` judges a number by the largest of its whole array, on either side. Classes of a scene: identical bits, within
1e-12, different. The milliseconds that `heun model` measures are left out. Leaves with 1 where anything differs (with
--bits: at all), or scenes are missing on one side (but for those that --quick leaves out).
"""

from __future__ import annotations

import argparse
import contextlib
import gc
import gzip
import hashlib
import io
import json
import multiprocessing as mp
import os
import re
import shutil
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import numpy as np

NEAR = 1e-12
LIMIT = 180  # seconds a scene may take (others may use the machine, too); twice that and its worker is killed
QUICK = 150  # scenes of --scenes under --quick
WITH_TABLE = 2  # of the scenes of --scenes every so manieth (by its name) is told as tables and measured, too
EVERYTHING = "motion,points,foundation,joints,sections,forces,energy"
VOLATILE = (("version",), ("spec",), ("work", "seconds"))
HEADING = re.compile(r"^(\W*heun\W+)\d+\.\d+\S*", re.M)
BLANKS = rb"(?:\\n| )+"  # in a line of JSON; where a sentence is broken goes by the digits in it
MEASURED = (
    re.compile(  # of `heun model`: "the first 0.4 s take 4 steps, 33 evaluations, 0.91 ms; the whole run ... again"
        BLANKS.join((rb"evaluations?,", rb"[\d.e+-]+", rb"ms;", rb"the", rb"whole", rb"run")) + rb'[^"]*?again'
    )
)
NUMBER = re.compile(r"(?<![A-Za-z_\d.])[-+−]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


# record ----------------------------------------------------------------------------------------------------------


class Late(BaseException):
    """A scene took too long; no Exception, that heun may not take it for a bug of its own."""


def heun(*words: str) -> dict[str, Any]:
    """One command line in this process: exit code, both streams, and what Python warned of."""
    from heuncli.__main__ import main

    out = io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True)
    err = io.StringIO()
    kept = sys.argv
    sys.argv = ["heun", *words]
    code: Any = 0
    with warnings.catch_warnings(record=True) as caught, contextlib.redirect_stdout(out):
        warnings.simplefilter("always")
        with contextlib.redirect_stderr(err):
            try:
                main()
            except SystemExit as leaving:
                code = leaving.code
            finally:
                sys.argv = kept
    done = {"exit": code, "out": out.buffer.getvalue().decode(), "err": err.getvalue()}  # type: ignore[attr-defined]
    told = sorted({f"{w.category.__name__}: {w.message}" for w in caught})
    return done | ({"python": told} if told else {})


def stripped(text: str) -> Any:
    """The JSON without what changes from run to run."""
    data = json.loads(text)
    for *above, last in VOLATILE:
        block = data
        for key in above:
            block = block.get(key, {})
        block.pop(last, None)
    return data


def clean(done: dict[str, Any], folder: str) -> dict[str, Any]:
    """Without absolute paths and versions."""
    for key in ("out", "err"):
        done[key] = HEADING.sub(r"\1VERSION", done[key].replace(folder + os.sep, "").replace(folder, "."))
    return done


def outcome(scene: dict[str, Any]) -> dict[str, Any]:
    """What heun says of one scene, command by command."""
    path, words, kind = scene["path"], scene["words"], scene["kind"]
    folder = str(Path.cwd())
    sets = [w for i, w in enumerate(words) if w == "--set" or (i and words[i - 1] == "--set")]
    said: dict[str, Any] = {"validate": heun("validate", path)}
    run = heun("run", path, *words, "--format", "json", "--only", EVERYTHING)
    data = None
    if run["exit"] == 0:
        data = stripped(run.pop("out"))
        run["json"], run["out"] = data, ""
    said["run"] = run
    if kind != "broken":
        said["model"] = heun("model", path, *sets)
    if data is not None and "\nexpect" in scene["text"]:
        said["check"] = heun("check", path)
    if data is not None and (kind == "spec" or scene["table"]):
        said["table"] = heun("run", path, *words)
        for measure in measures(data):
            said[f"measure {measure}"] = heun("run", path, *words, "--measure", measure)
    if data is not None and kind == "spec":
        times = data["time"]
        said["model json"] = heun("model", path, *sets, "--format", "json")
        if len(times) > 1:
            between = 0.37 * times[0] + 0.63 * times[-1]
            said["at"] = heun("run", path, *words, "--at", repr(between), "--format", "json", "--only", EVERYTHING)
        said["usual"] = heun("run", path, *words, "--format", "json")
        said["markdown"] = heun("run", path, *words, "--format", "markdown", "--only", "joints,energy")
        csv = heun("run", path, *words, "--format", "csv", "--only", "joints,sections,energy")
        digest, lines = hashlib.sha256(csv["out"].encode()).hexdigest(), csv["out"].count("\n")
        csv["out"] = f"sha256 {digest}, {lines} lines"
        said["csv"] = csv
        for name in ("model json", "at"):
            if name in said and said[name]["exit"] == 0:
                said[name]["json"], said[name]["out"] = stripped(said[name]["out"]), ""
        usual = said["usual"]
        if usual["exit"] == 0:  # its numbers stand in the full one; unless they do not
            found = stripped(usual["out"])
            same = all(found[key] == data.get(key) for key in found)
            usual["out"] = f"{list(found)} as in the full one" if same else ""
            if not same:
                usual["json"] = found
    for done in said.values():
        clean(done, folder)
    return said


def measures(data: dict[str, Any]) -> list[str]:
    """A few measures that suit the scene."""
    timed = len(data["time"]) > 1
    found = [f"{'max abs ' if timed else ''}joints.{name}.force" for name in list(data.get("joints", {}))[-1:]]
    for name, part in list(data.get("sections", {}).items())[:1]:
        found += [f"max abs sections.{name}.M1"] if "M1" in part else []
    if timed:
        found += ["final energy.kinetic"] if "energy" in data else []
        found += [f"max coordinates.{name}.{key}" for name, c in data.get("coordinates", {}).items() for key in c][:1]
    paths = (word.removeprefix("max abs ").removeprefix("max ").removeprefix("final ") for word in found)
    return [word for word, path in zip(found, paths, strict=True) if " " not in path]


def recorded(scene: dict[str, Any], scratch: Path) -> dict[str, Any]:
    """One line of the record."""
    begun = time.perf_counter()
    if scene["kind"] == "test":
        for name, text in {"scene.yaml": scene["text"], **scene["files"]}.items():
            (scratch / name).parent.mkdir(parents=True, exist_ok=True)
            (scratch / name).write_bytes(text.encode("utf-8", "surrogateescape"))
        os.chdir(scratch)
    else:
        os.chdir(scene["root"])
    sha = hashlib.sha256(json.dumps([scene["text"], scene["files"], scene["words"]]).encode()).hexdigest()[:16]
    line: dict[str, Any] = {"scene": scene["name"], "sha": sha}
    signal.alarm(LIMIT)
    try:
        line["said"] = outcome(scene)
    except Late:
        line["said"] = {"late": {"exit": None, "out": f"took more than {LIMIT} s", "err": ""}}
    except BaseException as bug:  # a finding, too
        text = "".join(traceback.format_exception_only(bug))
        line["said"] = {"crash": {"exit": None, "out": text, "err": ""}}
    finally:
        signal.alarm(0)
        os.chdir("/")
        if scene["kind"] == "test":
            shutil.rmtree(scratch)
            scratch.mkdir()
    line["seconds"] = round(time.perf_counter() - begun, 3)
    return line


def late(*_: Any) -> None:
    """The alarm."""
    raise Late


def work(pipe: Any, scenes: list[dict[str, Any]]) -> None:
    """A worker: takes numbers of scenes, gives lines."""
    signal.signal(signal.SIGALRM, late)
    gc.freeze()
    gc.freeze = lambda: None
    with tempfile.TemporaryDirectory() as folder:
        done = 0
        while (number := pipe.recv()) is not None:
            scratch = Path(folder).resolve() / "s"
            scratch.mkdir(exist_ok=True)
            row = json.dumps(recorded(scenes[number], scratch), ensure_ascii=False)
            pipe.send_bytes(row.encode("utf-8", "replace"))
            done += 1
            if done % 20 == 0:
                gc.collect()
    pipe.close()


class Worker:
    """A process, and the scene it is at."""

    def __init__(self, scenes: list[dict[str, Any]]) -> None:
        self.pipe, theirs = mp.Pipe()
        self.process = mp.get_context("fork").Process(target=work, args=(theirs, scenes), daemon=True)
        self.process.start()
        theirs.close()
        self.number: int | None = None
        self.since = 0.0

    def give(self, number: int | None) -> None:
        self.number, self.since = number, time.monotonic()
        self.pipe.send(number)

    def end(self) -> None:
        self.process.kill()
        self.process.join()
        self.pipe.close()


def lines(scenes: list[dict[str, Any]], jobs: int) -> Iterator[tuple[int, bytes]]:
    """The record's lines as they come, with the numbers of their scenes."""
    left = iter(range(len(scenes)))
    workers = [Worker(scenes) for _ in range(max(1, min(jobs, len(scenes))))]
    for worker in workers:
        worker.give(next(left))
    while any(worker.number is not None for worker in workers):
        ready = wait([w.pipe for w in workers if w.number is not None], timeout=5)
        for place, worker in enumerate(workers):
            number = worker.number
            if number is None:
                continue
            lost = time.monotonic() - worker.since > 2 * LIMIT
            if worker.pipe in ready:
                try:
                    yield number, worker.pipe.recv_bytes()
                    worker.give(next(left, None))
                    continue
                except (EOFError, ConnectionError):
                    lost = True
            if lost:
                worker.process.join(timeout=1)
                why = f"worker ended with {worker.process.exitcode}"
                said = {"crash": {"exit": None, "out": why, "err": ""}}
                line = {"scene": scenes[number]["name"], "sha": "", "said": said, "seconds": 0}
                yield number, json.dumps(line).encode()
                worker.end()
                workers[place] = worker = Worker(scenes)
                worker.give(next(left, None))
    for worker in workers:
        worker.process.join(timeout=5)
        worker.end()


def of_checkout(root: Path, quick: bool) -> list[dict[str, Any]]:
    """The scenes that lie in the repository; specs also solved in full and, some, with what is open split."""
    found = []
    for folder, kind in (("specs", "spec"), ("tests/bench/scenes", "spec"), ("specs/broken", "broken")):
        for path in sorted((root / folder).glob("*.yaml")):
            name = str(path.relative_to(root))
            text = path.read_bytes().decode("utf-8", "surrogateescape")
            data = sorted(p for p in path.parent.glob("*.csv"))
            files = {p.name: p.read_text() for p in data if p.name in text}
            base = {"path": name, "text": text, "files": files, "root": str(root), "table": True}
            found.append({**base, "name": name, "kind": kind, "words": []})
            if folder == "specs" and not quick:
                for word in ("--no-reduce", "--least-norm"):
                    found.append({**base, "name": f"{name} {word}", "kind": "option", "words": [word], "table": False})
    return found


def of_file(path: Path, quick: bool) -> list[dict[str, Any]]:
    """Further scenes."""
    entries = json.loads(gzip.decompress(path.read_bytes()))
    step = max(1, len(entries) // QUICK) if quick else 1
    chosen = entries[::step][: QUICK if quick else None]
    return [
        {
            "name": e["name"], "text": e["text"], "files": e.get("files", {}), "words": e.get("words", []),
            "path": "scene.yaml", "kind": "test",
            "table": hashlib.sha256(e["name"].encode()).digest()[0] % WITH_TABLE == 0,
        }
        for e in chosen
    ]  # fmt: skip


def record(out: Path, scenes_file: Path | None, quick: bool, jobs: int, root: Path | None) -> int:
    """Run every scene and write the record."""
    import heuncli.__main__
    from heuncli.version import VERSION

    begun = time.perf_counter()
    package = Path(heuncli.__file__ or heuncli.__path__[0]).resolve()
    root = (root or (package.parent if package.is_file() else package).parent).resolve()
    scenes = of_checkout(root, quick) + (of_file(scenes_file, quick) if scenes_file else [])
    names = Counter(scene["name"] for scene in scenes)
    if twice := [name for name, n in names.items() if n > 1]:
        raise SystemExit(f"names given twice: {twice[:5]}")
    said = heun("--version")["out"].strip()
    print(f"{said}, {package.parent}: {len(scenes)} scenes, {jobs} at a time", file=sys.stderr)
    for module in ("run.command", "model", "validate", "check.command"):
        with contextlib.suppress(ImportError):  # only saves the workers' time
            __import__(f"heuncli.app.commands.{module}")
    head = {"head": {"version": VERSION, "said": said, "root": str(root), "scenes": len(scenes), "quick": quick}}
    exits: Counter[Any] = Counter()
    slow: list[tuple[float, str]] = []
    kept: dict[int, bytes] = {}
    following = 0
    part = out.with_name(out.name + ".part")
    with gzip.open(part, "wb", compresslevel=1) as file:
        file.write(json.dumps(head).encode() + b"\n")
        for number, line in lines(scenes, jobs):
            kept[number] = line
            while following in kept:  # in the order of the scenes
                told = kept.pop(following)
                file.write(told + b"\n")
                match = re.search(rb'"seconds": ([\d.]+)}$', told)
                slow.append((float(match[1]) if match else 0.0, scenes[following]["name"]))
                exits["crash" if b'"said": {"crash"' in told else "late" if b'"said": {"late"' in told else "ok"] += 1
                following += 1
    part.replace(out)
    print(f"{out}: {following} scenes in {time.perf_counter() - begun:.0f} s, {dict(exits)}", file=sys.stderr)
    print("slowest: " + ", ".join(f"{name} {s:.1f} s" for s, name in sorted(slow)[:-6:-1]), file=sys.stderr)
    return 0


# diff ------------------------------------------------------------------------------------------------------------

SEVERITY = {
    "scene": 0, "crash": 0, "exit": 1, "shape": 2, "null": 3, "words": 4, "count": 5, "number": 6,
    "digits": 7, "noise": 8, "order": 9, "near": 10,
}  # fmt: skip


class Finding:
    """One path of one scene where the two differ."""

    def __init__(self, scene: str, path: str, kind: str, text: str, size: float = 0.0) -> None:
        self.scene, self.path, self.kind, self.text, self.size = scene, path, kind, text, size

    def key(self) -> tuple[Any, ...]:
        return SEVERITY[self.kind], -self.size, self.scene, self.path


def family(path: str) -> str:
    """Which quantities are of one kind, so that rounding of the one is none of the other."""
    last = re.sub(r"\W?\d+$", "", path.rsplit(".", 1)[-1])
    if path.split(".")[0] in ("energy", "accuracy", "model", "status", "time"):
        return path.split(".")[0]
    if "accel" in last:
        return "acceleration"
    if "veloc" in last or last in ("rate", "speed"):
        return "velocity"
    if last in ("position", "center", "point", "length", "travel", "angle", "rotation", "s"):
        return "place"
    if path.startswith("momentum") or "momentum" in last:
        return "momentum"
    if path.startswith("system_vector"):
        return "system_vector"
    return "load"


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Paths and what stands there; lists of plain data stand whole."""
    if isinstance(value, dict):
        yield f"{path} keys", list(value)
        for key, member in value.items():
            yield from leaves(member, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and any(isinstance(member, dict) for member in value):
        yield f"{path} length", len(value)
        for number, member in enumerate(value):
            yield from leaves(member, f"{path}.{number}")
    else:
        yield path, value


def array(value: Any) -> Any:
    """The numbers of a leaf, open ones nan; None where it is no matter of floats."""
    if isinstance(value, float):
        return np.array(value)
    if not isinstance(value, list):
        return None
    flat = value
    while flat and isinstance(flat[0], list):
        flat = [member for part in flat if isinstance(part, list) for member in part]
    if not flat or any(isinstance(m, (str, bool, list, dict)) for m in flat) or all(m is None for m in flat):
        return None
    if all(isinstance(m, int) for m in flat):
        return None
    try:
        return np.array(value, dtype=float)  # None becomes nan
    except (TypeError, ValueError):
        return None


class Scene:
    """The comparison of one scene."""

    def __init__(self, name: str, ignore: list[re.Pattern[str]]) -> None:
        self.name, self.ignore = name, ignore
        self.findings: list[Finding] = []
        self.largest = (0.0, "")

    def tell(self, path: str, kind: str, text: str, size: float = 0.0) -> None:
        self.findings.append(Finding(self.name, path, kind, text, size))

    def ignored(self, path: str) -> bool:
        return any(pattern.search(path) for pattern in self.ignore)

    def said(self, old: dict[str, Any], new: dict[str, Any]) -> None:
        for command in dict.fromkeys([*old, *new]):
            if self.ignored(command) or old.get(command) == new.get(command):
                continue
            if command not in old or command not in new:
                self.tell(command, "exit", "only in the " + ("old" if command in old else "new"))
                continue
            a, b = old[command], new[command]
            if a["exit"] != b["exit"]:
                self.tell(command, "exit", f"exit code {a['exit']} | {b['exit']}; {cut(b['err'] or b['out'])}")
            for stream in ("out", "err", "python"):
                if self.ignored(f"{command}:{stream}") or a.get(stream) == b.get(stream):
                    continue
                if command == "csv" and stream == "out" and old.get("run") != new.get("run"):  # a hash of its numbers
                    self.tell("csv:out", "near", "another hash, as the numbers of the JSON are others, too")
                else:
                    self.text(f"{command}:{stream}", str(a.get(stream, "")), str(b.get(stream, "")))
            if ("json" in a) != ("json" in b):
                self.tell(command, "shape", "JSON on one side only")
            elif "json" in a:
                self.json(a["json"], b["json"], "" if command == "run" else f"{command}:")

    def text(self, path: str, a: str, b: str) -> None:
        """Texts: numbers apart from words."""
        if a == b:
            return
        words = [re.sub(r"[\s\-−]+", " ", NUMBER.sub(" # ", t)) for t in (a, b)]
        size = 0.0
        if words[0].split() == words[1].split():
            numbers = [np.array([float(n.replace("−", "-")) for n in NUMBER.findall(t)]) for t in (a, b)]
            if numbers[0].shape == numbers[1].shape:
                scale = np.maximum(np.abs(numbers[0]), np.abs(numbers[1]))
                size = float(np.max(np.abs(numbers[1] - numbers[0]) / np.where(scale > 0, scale, 1), initial=0.0))
                near = 0.0 < size <= NEAR
                if near or size > NEAR:
                    self.tell(path, "near" if near else "digits", f"{first_line(a, b)}", size)
                    return
        self.tell(path, "words", first_line(a, b))

    def json(self, old: Any, new: Any, prefix: str) -> None:
        a, b = dict(leaves(old)), dict(leaves(new))
        arrays = {path: (array(a[path]), array(b[path])) for path in a if path in b}
        sizes: dict[str, float] = {}
        for path, pair in arrays.items():
            for values in pair:
                if values is not None and values.size:
                    top = float(np.nanmax(np.abs(values))) if not np.isnan(values).all() else 0.0
                    sizes[family(path)] = max(sizes.get(family(path), 0.0), top)
        for path in dict.fromkeys([*a, *b]):
            full = prefix + path
            if self.ignored(full) or (path in a and path in b and same(a[path], b[path])):
                continue
            if path not in a or path not in b:
                self.tell(full, "shape", "only in the " + ("old" if path in a else "new"))
            elif path.endswith(" keys"):
                if sorted(a[path]) == sorted(b[path]):
                    self.tell(full, "order", f"{cut(a[path])} | {cut(b[path])}")
            else:
                self.leaf(full, a[path], b[path], arrays[path], sizes.get(family(path), 0.0))

    def leaf(self, path: str, a: Any, b: Any, arrays: tuple[Any, Any], whole: float) -> None:
        x, y = arrays
        if x is None or y is None:
            if (a is None or b is None) or (x is not None or y is not None):
                self.tell(path, "null" if nulls(a) != nulls(b) else "shape", f"{cut(a)} | {cut(b)}")
            elif isinstance(a, int) and isinstance(b, int):
                self.tell(path, "count", f"{a} | {b}", float(abs(a - b)))
            elif isinstance(a, str) and isinstance(b, str):
                self.text(path, a, b)
            elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b) and {*map(type, a + b)} == {str}:
                for number, (one, other) in enumerate(zip(a, b, strict=True)):
                    self.text(f"{path}.{number}", one, other)
            else:
                self.tell(path, "words", f"{cut(a)} | {cut(b)}")
            return
        if x.shape != y.shape:
            self.tell(path, "shape", f"shape {x.shape} | {y.shape}")
            return
        if (apart := np.isnan(x) != np.isnan(y)).any():
            where = np.argwhere(apart)[0].tolist()
            self.tell(path, "null", f"open on one side at {where} and {int(apart.sum()) - 1} more", float(apart.sum()))
            x, y = np.where(apart, 0.0, x), np.where(apart, 0.0, y)
        away = np.where(np.isnan(x), 0.0, np.abs(y - x))
        top = float(max(np.nanmax(np.abs(x), initial=0.0), np.nanmax(np.abs(y), initial=0.0)))
        far = float(away.max(initial=0.0))
        if far == 0.0 or top == 0.0:
            return
        size = far / top
        place = np.unravel_index(int(np.argmax(away)), away.shape) if away.ndim else ()
        at = f"[{','.join(map(str, place))}]" if place else ""
        text = f"{size:.2e} of the largest, {top:.3g}: {float(x[place])!r} | {float(y[place])!r} {at}"
        if size <= NEAR:
            self.tell(path, "near", text, size)
        elif top <= NEAR * whole:
            self.tell(path, "noise", f"{text}; all of it within {top / whole:.0e} of its like", size)
            return
        else:
            self.tell(path, "number", text, size)
        if size > self.largest[0]:
            self.largest = (size, path)


def same(a: Any, b: Any) -> bool:
    """Equal, and of one type (1 is not 1.0); inside lists by value."""
    return type(a) is type(b) and a == b


def nulls(value: Any) -> int:
    """How many nulls stand there."""
    return sum(map(nulls, value)) if isinstance(value, list) else int(value is None)


def cut(value: Any, most: int = 150) -> str:
    """Its beginning, on one line."""
    text = " ".join(str(value).split())
    return text if len(text) <= most else text[: most - 3] + "..."


def first_line(a: str, b: str) -> str:
    """The first line in which two texts differ."""
    old, new = a.splitlines(), b.splitlines()
    for one, other in zip(old, new, strict=False):
        if one != other:
            return f"{cut(one)} | {cut(other)}"
    more = (old if len(old) > len(new) else new)[min(len(old), len(new)) :]
    return f"more lines in the {'old' if len(old) > len(new) else 'new'}: {cut(more[0]) if more else ''}"


def opened(path: Path) -> tuple[dict[str, Any], dict[str, bytes]]:
    """A record's head and its lines by scene."""
    found = {}
    with gzip.open(path, "rb") as file:
        head = json.loads(next(file))["head"]
        for line in file:
            match = re.match(rb'\{"scene": ("(?:[^"\\]|\\.)*")', line)
            if match is None:
                raise SystemExit(f"{path}: not a record of this tool")
            unmeasured = MEASURED.sub(mask_time, line)
            found[json.loads(match[1])] = re.sub(rb', "seconds": [\d.]+}\n$', b"}", unmeasured)
    return head, found


def mask_time(found: re.Match[bytes]) -> bytes:
    """The forecast of a run without the time measured, on one line."""
    return re.sub(rb"[\d.e+-]+ ms;", b"MEASURED ms;", re.sub(BLANKS, b" ", found[0]))


def diff(old_path: Path, new_path: Path, bits: bool, noise: bool, ignore: list[str], most: int) -> int:
    """Tell what differs; 1 if anything does."""
    (old_head, old), (new_head, new) = opened(old_path), opened(new_path)
    print(f"old: {old_head['said']}, {old_head['root']}\nnew: {new_head['said']}, {new_head['root']}")
    patterns = [re.compile(text) for text in ignore]
    findings: list[Finding] = []
    counts: Counter[str] = Counter()
    largest, largest_noise = (0.0, "", ""), (0.0, "", "")
    common = [name for name in old if name in new]
    for name in common:
        if old[name] == new[name]:
            counts["identical"] += 1
            continue
        a, b = json.loads(old[name]), json.loads(new[name])
        scene = Scene(name, patterns)
        if a["sha"] != b["sha"] and a["sha"] and b["sha"]:
            scene.tell("", "scene", "the scene itself has another text")
        scene.said(a["said"], b["said"])
        if scene.largest[0] > largest[0]:
            largest = (scene.largest[0], name, scene.largest[1])
        for finding in scene.findings:
            if finding.kind == "noise" and finding.size > largest_noise[0]:
                largest_noise = (finding.size, name, finding.path)
        small = {"near", "noise"} if noise else {"near"}
        kinds = {finding.kind for finding in scene.findings}
        counts["identical" if not kinds else "near" if kinds <= small else "different"] += 1
        findings += [f for f in scene.findings if bits or f.kind not in small]
    findings.sort(key=Finding.key)
    for finding in findings[:most]:
        print(f"{finding.kind:6} {finding.scene}  {finding.path}: {finding.text}")
    if len(findings) > most:
        print(f"... and {len(findings) - most} more (--most)")
    if findings:
        by_kind = Counter(finding.kind for finding in findings)
        print("by kind: " + ", ".join(f"{kind} {by_kind[kind]}" for kind in SEVERITY if by_kind[kind]))
        ends = (f"{f.path.split('.')[0]} ... {f.path.split('.')[-1]}" for f in findings)
        by_path = Counter(re.sub(r"\.\d+", ".#", path) for path in ends)
        print("by path: " + ", ".join(f"{path} {n}" for path, n in by_path.most_common(12)))
    few = old_head["quick"], new_head["quick"]  # a quick record lacks most scenes
    missing = [(name, "old") for name in old if name not in new and not few[1]]
    missing += [(name, "new") for name in new if name not in old and not few[0]]
    for name, side in missing[:10]:
        print(f"only in the {side}: {name}")
    if missing:
        print(f"{len(missing)} scenes on one side only, not compared (a finding)")
    if largest[0]:
        print(f"largest relative deviation: {largest[0]:.2e}, {largest[1]}  {largest[2]}")
    if largest_noise[0]:
        print(f"... among quantities that are rounding: {largest_noise[0]:.2e}, {largest_noise[1]}  {largest_noise[2]}")
    n, a, b, c = len(common), counts["identical"], counts["near"], counts["different"]
    print(f"{n} scenes: {a} identical, {b} within {NEAR:g}, {c} differ")
    return int(c > 0 or (bits and b > 0) or bool(missing))


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="compare", description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    taking = commands.add_parser("record", help="run every scene, write what heun says")
    taking.add_argument("out", type=Path)
    taking.add_argument("--scenes", type=Path, help="a gz of further scenes")
    taking.add_argument("--quick", action="store_true", help=f"only {QUICK} of the further scenes")
    taking.add_argument("--jobs", type=int, default=2)
    taking.add_argument("--root", type=Path, help="the checkout whose specs are run; that of heuncli by itself")
    telling = commands.add_parser("diff", help="tell what differs")
    telling.add_argument("old", type=Path)
    telling.add_argument("new", type=Path)
    telling.add_argument("--bits", action="store_true", help="list whatever is not the same to the bit")
    telling.add_argument("--noise", action="store_true", help="forgive arrays that are rounding beside their like")
    telling.add_argument("--ignore", action="append", default=[], metavar="PATHREGEX")
    telling.add_argument("--most", type=int, default=200, help="lines to print")
    given = parser.parse_args()
    if given.command == "record":
        out, scenes = given.out.resolve(), given.scenes.resolve() if given.scenes else None
        return record(out, scenes, given.quick, given.jobs, given.root)
    return diff(given.old, given.new, given.bits, given.noise, given.ignore, given.most)


if __name__ == "__main__":
    sys.exit(main())
