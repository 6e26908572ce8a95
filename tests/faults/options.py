"""Every command with every one of its options on every spec ends as documented, with numbers finite or marked.

The commands and options are those of the registry. An option gets its words from LINES here; one that stands in none
of them is a fault of this file, which `uncovered` names. The whole product is some thousands of runs:

    python -m tests.faults.options [--command run] [--scene rotor] [--share 1/4] [--time-limit 3]

The suite runs a share of it: every line once, every scene at least once (`test_options.py`).
"""

from __future__ import annotations

import argparse
import json
import re
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from heuncli.app.cli.options import list_fields
from heuncli.app.cli.registry import COMMANDS
from heuncli.base.errors import HeunError
from heuncli.base.joint_kinds import JOINTS
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.source import parse_source
from tests.shared.all_scenes import all_scenes, link_files
from tests.shared.command import Done
from tests.shared.folders import ROOT
from tests.shared.in_process import run_command

CODES = (0, 1, 2, 3, 4)  # manual/commands.md, "Exit codes": the others are a bug, a full disk, signals
# The lines of each command. In braces what `words_of` finds in a scene; `{out}` is a folder of this run.
LINES: Mapping[str, Sequence[str]] = {
    "run": (
        "{spec} --format json --by-cause",
        "{spec} --summary --title T --label {path}=Words",
        "{spec} --full",
        "{spec} --hardpoints --format json",
        "{spec} --format csv --by-cause -q",
        "{spec} --format markdown -v",
        "{spec} --format table --units kN,mm,deg,rpm --all",
        "{spec} -o {out}/run.json",
        "{spec} --at first,last",
        "{spec} --by-cause",
        "{spec} --only joints,foundation,motion,points,energy,events,impulses,sections,forces,shares",
        "{spec} --only {entry}",
        "{spec} --set {setting}",
        "{spec} --case {case}",
        "{spec} --case all --format json",
        "{spec} --measure {measure} --measure {other}",
        "{spec} --collective {path} --slope 3,5 --cycles 1e6 --bins 8",
        "{spec} --collective {path} --repeat 2 --format json",
        "{spec} --collective {path} --repeat closed",
        "{spec} --method RK4 --step {step}",
        "{spec} --method Radau5",
        "{spec} --tolerance 1e-6 --format json",
        "{spec} --no-reduce --format json",
        "{spec} --least-norm --format json --strict",
        "{spec} --axes from --format json",
        "{spec} --axes to",
        "{spec} --strict",
        "{spec} --time-limit 1",
    ),
    "validate": ("{spec}", "{spec} -q --time-limit 5"),
    "model": (
        "{spec}",
        "{spec} --format json",
        "{spec} --format text -o {out}/model.txt",
        "{spec} --set {setting} -q",
        "{spec} --case {case}",
        "{spec} --no-reduce",
        "{spec} --sketch",
        "{spec} --sketch --view 30,20 --width 60",
        "{spec} --time-limit 2",
    ),
    "modes": (
        "{spec} --time-limit {limit}",
        "{spec} --format json --time-limit {limit}",
        "{spec} --format csv --time-limit {limit}",
        "{spec} -o {out}/modes.json --time-limit {limit}",
        "{spec} --set {setting} -q --time-limit {limit}",
        "{spec} --case {case} --time-limit {limit}",
        "{spec} --without {force} --time-limit {limit}",
    ),
    "balance": (
        "{spec} --time-limit {limit}",
        "{spec} --format json --time-limit {limit}",
        "{spec} --format csv --time-limit {limit}",
        "{spec} -o {out}/balance.json --time-limit {limit}",
        "{spec} --save {out}/orders.svg --time-limit {limit}",
        "{spec} --cycle {angle} --time-limit {limit}",
        "{spec} --turns 2 --rate 100rpm --time-limit {limit}",
        "{spec} --period {end} --time-limit {limit}",
        "{spec} --orders 1,2,4 --about 0,0,0 --time-limit {limit}",
        "{spec} --counterweight {point}:radius=50mm --minimise mix --lever 0.1m --time-limit {limit}",
        "{spec} --minimise force --counterweight {point}:radius=50mm --format json --time-limit {limit}",
        "{spec} --flywheel 0.02 --time-limit {limit}",
        "{spec} --set {setting} -q --time-limit {limit}",
        "{spec} --case {case} --time-limit {limit}",
    ),
    "chart": (
        "{spec} --methods RK4,DOP853 --tolerances 1e-4 --steps {step} --time-limit {limit}",
        "{spec} --methods RK4,DOP853 --tolerances 1e-3 --steps {step} --format json --time-limit {limit}",
        "{spec} --methods RK4 --steps {step} --format csv --time-limit {limit}",
        "{spec} --methods DOP853 --tolerances 1e-4 --save {out}/chart.svg --time-limit {limit}",
        "{spec} --methods DOP853 --tolerances 1e-4 -o {out}/chart.json --set {setting} -q --time-limit {limit}",
        "{spec} --methods DOP853 --tolerances 1e-4 --case {case} --time-limit {limit}",
    ),
    "probe": (
        "{spec} --time-limit {limit}",
        "{spec} --format json --time-limit {limit}",
        "{spec} -o {out}/probe.json --set {setting} -q --time-limit {limit}",
        "{spec} --case {case} --time-limit {limit}",
    ),
    "lagrange": (
        "{spec}",
        "{spec} --format json",
        "{spec} --format csv -o {out}/lagrange.csv",
        "{spec} --at 0",
        "{spec} --at {end}",
        "{spec} --over {coordinate}=0.01:0.02/3",
        "{spec} --over {coordinate}=0.01:0.02/3 --format json",
        "{spec} --coordinates {coordinate}",
        "{spec} --coordinates rodrigues",
        "{spec} --seen {coordinate},{point}:0,0,1",
        "{spec} --christoffel",
        "{spec} --christoffel --format json",
        "{spec} --state-space",
        "{spec} --state-space --format json",
        "{spec} --state-space --inputs {force} --outputs {coordinate},{point}.x",
        "{spec} --state-space --format m",
        "{spec} --only mass,forces,sections --units kN,mm",
        "{spec} --set {setting} -q",
        "{spec} --case {case}",
        "{spec} --time-limit 2",
    ),
    "sweep": (
        "{spec} {axis} --measure {measure} --time-limit {limit}",
        "{spec} {axis} --measure {measure} --measure {other} --format json --time-limit {limit}",
        "{spec} {axis} {axis2} --zip --measure {measure} --format csv --time-limit {limit}",
        "{spec} --variants {variants} --measure {measure} --time-limit {limit}",
        "{spec} {axis} --measure {measure} --store {out}/rows.db --time-limit {limit}",
        "--show {store}",
        "{spec} {axis} --measure {measure} --shard 1/2 --store {out}/shard.db --time-limit {limit}",
        "{spec} {axis} --measure {measure} --jobs 1 --all --units kN,mm,deg,rpm --time-limit {limit}",
        "{spec} {drawn} --samples 4 --seed 1 --measure {measure} --time-limit {limit}",
        "{spec} {drawn2} --samples 8 --indices --measure {measure} --time-limit {limit}",
        "{spec} {axis} --measure {measure} --format parquet -o {out}/rows.parquet --time-limit {limit}",
        "{spec} {axis} --measure {measure} -o {out}/rows.json --set {setting2} --strict -q --time-limit {limit}",
        "{spec} {axis} --measure {measure} --method RK4 --step {step} --time-limit {limit}",
        "{spec} {axis} --measure {measure} --tolerance 1e-6 --no-reduce --least-norm --time-limit {limit}",
        "{spec} {axis} --measure {measure} --dask tcp://127.0.0.1:1 --time-limit {limit}",
    ),
    "find": (
        "{spec} {interval} {condition} --scan 5 --evaluations 12 --time-limit {limit}",
        "{spec} {interval} {condition} --scan 5 --evaluations 12 --format json --time-limit {limit}",
        "{spec} {interval} {condition} --scan 5 --format csv -o {out}/find.csv --time-limit {limit}",
        "{spec} {interval} {condition} --scan 4 --tolerance 1e-6 --units kN,mm --set {setting2} --strict -q"
        " --time-limit {limit}",
        "{spec} {interval} {condition} --scan 4 --case {case} --time-limit {limit}",
    ),
    "sensitivity": (
        "{spec} {number} --measure {measure} --time-limit {limit}",
        "{spec} {number} --measure {measure} --format json --jobs 1 --time-limit {limit}",
        "{spec} {number} --measure {measure} --spread {spread} --format csv --time-limit {limit}",
        "{spec} {number} --measure {measure} --spread {spread} -o {out}/s.json --units kN,mm --strict -q"
        " --time-limit {limit}",
        "{spec} {number} --measure {measure} --tolerance 1e-7 --set {setting2} --case {case} --time-limit {limit}",
    ),
    "tune": (
        "{spec} {interval} --minimise {measure} --evaluations 8 --jobs 1 --time-limit {limit}",
        "{spec} {interval} --maximise {measure} --evaluations 8 --jobs 1 --format json --time-limit {limit}",
        "{spec} {interval} --minimise {measure} --subject-to {bound} --evaluations 8 --jobs 1 --seed 2"
        " --time-limit {limit}",
        "{spec} {interval} --minimise {measure} --evaluations 6 --jobs 1 --precision 1e-2 --history {out}/h.csv"
        " -o {out}/tune.json --strict -q --time-limit {limit}",
        "{spec} {interval} --minimise {measure} --evaluations 6 --jobs 1 --tolerance 1e-6 --no-reduce --units kN,mm"
        " --set {setting2} --case {case} --time-limit {limit}",
    ),
    "plot": (
        "{spec} {path} -o {out}/a.svg",
        "{spec} {path} --width 60 --units kN,mm,deg,rpm",
        "{spec} scene -o {out}/scene.svg",
        "{spec} {path} --title T --label {path}=Words -o {out}/named.svg",
        "{spec} scene --at last --view 30,20 --width 60",
        "{spec} {path} --x {x} -o {out}/x.svg",
        "{spec} {section} -o {out}/b.svg",
        "{spec} {section} --tension-side --at first",
        "{spec} polar {force_path} --axes to -o {out}/polar.svg",
        "{spec} modes --without {force} -o {out}/modes.svg --time-limit {limit}",
        "{spec} balance -o {out}/orders.svg --time-limit {limit}",
        "{spec} {path} --with {csv}:1:2 -o {out}/with.svg",
        "{spec} {path} --set {setting} -q",
        "{spec} {path} --case all -o {out}/c.svg",
        "{spec} {path} --method RK4 --step {step}",
        "{spec} {path} --tolerance 1e-6 --no-reduce --least-norm --time-limit 2",
    ),
    "show": (
        "{spec} -o {out}/show.html --title T --label {path}=Words --time-limit {limit}",
        "{spec} -o {out}/show.html --at 0 --time-limit {limit}",
        "{spec} -o {out}/f.html --glb {out}/scene.glb --frames 5 --time-limit {limit}",
        "{spec} -o {out}/a.html --units kN,mm,deg,rpm --set {setting} -q --time-limit {limit}",
        "{spec} -o {out}/c.html --case {case} --time-limit {limit}",
        "{spec} -o {out}/d.html --method RK4 --step {step} --time-limit {limit}",
        "{spec} -o {out}/e.html --tolerance 1e-6 --no-reduce --least-norm --time-limit {limit}",
    ),
    "report": (
        "{spec} -o {out}/report.html --title T --label {path}=Words --time-limit {limit}",
        "{spec} --format md -o - --time-limit {limit}",
        "{spec} -o {out}/r.md --date today --author me --project p --units kN,mm,deg,rpm -q --time-limit {limit}",
        "{spec} -o {out}/c.html --case {case} --set {setting} --time-limit {limit}",
        "{spec} -o {out}/t.html --company c --part 1 --revision B --logo {out}/logo.svg --time-limit {limit}",
        "{spec} -o {out}/l.html --chapters loads,spec --paper letter --landscape --decimal-comma --time-limit {limit}",
        "{spec} -o {out}/m.md --method RK4 --step {step} --time-limit {limit}",
        "{spec} -o {out}/n.md --tolerance 1e-6 --no-reduce --least-norm --time-limit {limit}",
    ),
    "export": (
        "urdf {spec} -o {out}/r.urdf --set {setting} --title T",
        "mjcf {spec} -o {out}/r.xml",
        "loads {spec} --body {body} --at first --format csv --title T --label {path}=Words",
        "loads {spec} --body {body} --at first,last --format json",
        "loads {spec} --body {body} --at first --format ansys -o {out}/a.dat",
        "loads {spec} --body {body} --at first --format nastran --units N,mm,t",
        "loads {spec} --body {body} --at first --format calculix --first-node 100 --elements all",
        "loads {spec} --body {body} --at first --format abaqus -q",
        "loads {spec} --body {body} --at first --mesh {out}/mesh.stl --format csv",
        "loads {spec} --body {body} --at first --blow-over 1e-3 --format json",
        "loads {spec} --body {body} --at first --case {case} --format json",
        "loads {spec} --body {body} --at first --set {setting} --format json",
        "loads {spec} --body {body} --at first --method RK4 --step {step} --format csv",
        "loads {spec} --body {body} --at first --tolerance 1e-6 --no-reduce --least-norm --format csv"
        " --time-limit {limit}",
    ),
    "check": (
        "{spec} --time-limit {limit}",
        "{spec} --format json --time-limit {limit} --jobs 1",
        "{spec} --format markdown --durations 3 --time-limit {limit}",
        "{spec} --format github -q --time-limit {limit}",
        "{spec} --golden {out}/golden --update -o {out}/check.txt --time-limit {limit}",
        "{spec} --golden {out}/golden --update --force --junit {out}/junit.xml --time-limit {limit}",
        "{spec} --golden {golden} --golden-tolerance 1e-3 --strict --time-limit {limit}",
        "{spec} -k scene -x --no-reduce --time-limit {limit}",
        "--references windows",
    ),
    "diff": (
        "{spec} {spec} --time-limit {limit}",
        "{spec} {changed} --format json --time-limit {limit}",
        "{spec} {changed} --format markdown --exit-code -q --time-limit {limit}",
        "{spec} {changed} --format github -o {out}/diff.txt --time-limit {limit}",
    ),
    "import": (
        "{urdf} -o {out}/a.yaml",
        "{urdf} --base fixed -o -",
        "{urdf} --base free --free --limits -o -",
        "{urdf} --density 1000 --repair zero -o - --time-limit 5 -q",
        "{urdf} --keyframe home --strict -o -",
        "{urdf} --model arm -o -",
    ),
    "methods": ("", "--format json", "--format table -o {out}/methods.txt"),
    "explain": ("", "format --no-pager", "run -o {out}/explain.txt"),
    "schema": ("", "--results", "--results -o {out}/schema.json"),
    "new": ("", "pendulum -", "rotor {out}/new.yaml"),
}
ALONE = frozenset({"import", "methods", "explain", "schema", "new"})  # of no scene
LEFT_OUT = {("run", "watch")}  # never ends: tests/cli/test_watch.py
STOPPED = re.compile(r"(?<![\w.-])(?:nan|inf|infinity)(?![\w.-])", re.IGNORECASE)


def uncovered() -> list[str]:
    """The options of the registry, and its commands, that stand in no line."""
    missing = [command.name for command in COMMANDS if command.name not in LINES]
    for command in COMMANDS:
        lines = " ".join(f" {line} " for line in LINES.get(command.name, ()))
        for field in list_fields(command.request):
            words = field.option.words
            if words and (command.name, field.name) not in LEFT_OUT and not any(f" {word} " in lines for word in words):
                missing.append(f"{command.name} {words[0]}")
    return missing


class Scene(NamedTuple):
    """A scene in a folder of its own, and the words that lines take from it."""

    name: str
    folder: Path
    words: Mapping[str, str]


MADE = {  # what a line looks at, and the line that makes it
    "{store}": ("sweep", "{spec} {axis} --measure {measure} --store {store} -q --time-limit {limit}"),
    "{golden}": ("check", "{spec} --golden {golden} --update -q --time-limit {limit}"),
}


def scene_in(folder: Path, name: str, text: str, limit: float) -> Scene:
    """Write a scene with all that lines name; one without load cases gets one that changes nothing."""
    link_files(folder)
    path = folder / "scene.yaml"
    if not re.search(r"^cases:|\"cases\":", text, re.MULTILINE) and text.lstrip()[:1] != "{":
        text = f"{text.rstrip()}\ncases: {{plain: {{set: {{}}}}}}\n"
    path.write_text(text, encoding="utf-8")
    return Scene(name, folder, words_of(path, text, limit))


def words_of(path: Path, text: str, limit: float) -> dict[str, str]:
    """What lines ask of a scene: names that it has, or names that it has not, where it has none."""
    tree = parse_source(path.name, text, "").data
    numbers = [*numbers_in(tree)]
    (number, value), (second, other) = (numbers * 2)[:2] if numbers else (("none", 1.0), ("none", 1.0))
    try:
        spec = load(str(path), text)
    except HeunError:
        spec = None
    joints = {name: joint.kind for name, joint in spec.joints.items()} if spec else {}
    body = next(iter(tree.get("bodies") or {"none": {}}))
    point = next(
        (f"{b}.{p}" for b, own in (tree.get("bodies") or {}).items() for p in own.get("points") or {}), "none.p"
    )
    joint = next(iter(joints), "none")
    coordinate = next((f"{n}.{q}" for n, kind in joints.items() for q in JOINTS[kind].coordinates), "none.angle")
    angle = next((f"{n}.angle" for n, kind in joints.items() if "angle" in JOINTS[kind].coordinates), "none.angle")
    section, case = (next(iter(tree.get(block) or {}), "none") for block in ("sections", "cases"))
    force = next(iter({**(tree.get("forces") or {}), **(tree.get("drives") or {})}), "none")
    end = max(spec.analysis.times, default=0.0) if spec else 0.0
    measure = f"max joints.{joint}.force" if joints else f"max bodies.{body}.center_acceleration"
    store, golden, variants = path.parent / "store.db", path.parent / "golden", path.parent / "variants.csv"
    (path.parent / "measured.csv").write_text("t,x\n0,1\n1,2\n")
    variants.write_text(f"{number}\n{value!r}\n")
    (path.parent / "changed.yaml").write_text(text.replace("heun: 1\n", "heun: 1\n", 1))
    return {
        "spec": str(path), "changed": str(path.parent / "changed.yaml"), "entry": f"joints.{joint}", "body": body,
        "setting": f"{number}={value!r}", "setting2": f"{second}={other!r}", "case": case, "measure": measure,
        "other": f"final bodies.{body}.center.x", "path": f"bodies.{body}.center",
        "force_path": f"joints.{joint}.force",
        "x": "time" if coordinate.startswith("none") else f"coordinates.{coordinate}", "coordinate": coordinate,
        "angle": angle, "point": point, "section": f"sections.{section}", "force": force, "number": number,
        "axis": f"{number}={value!r},{value * 1.001 + 1e-9!r}", "axis2": f"{second}={other!r},{other * 1.001 + 1e-9!r}",
        "drawn": f"{number}=normal({value!r},{abs(value) * 1e-3 + 1e-9!r})",
        "drawn2": f"{number}=sobol({value!r},{value + abs(value) * 1e-3 + 1e-9!r})",
        "interval": f"{number}={value!r}:{value + abs(value) * 1e-2 + 1e-6!r}", "condition": f"{measure} = 1",
        "bound": f"{measure} < 1e6",
        "spread": f"{number}={abs(value) * 1e-3 + 1e-9!r}", "step": f"{max(end, 0.1) / 20:.3g}", "end": f"{end:.6g}",
        "limit": f"{limit:g}", "store": str(store), "golden": str(golden), "variants": str(variants),
        "csv": str(path.parent / "measured.csv"), "urdf": str(ROOT / "specs" / "arm.urdf"),
    }  # fmt: skip


def numbers_in(tree: Any) -> Iterator[tuple[str, float]]:
    """Parameters that are numbers, then dotted keys with plain numbers."""
    for name, value in (tree.get("parameters") or {}).items():
        if type(value) in (int, float):
            yield name, float(value)
    for block in ("bodies", "forces", "joints"):
        for name, entry in (tree.get(block) or {}).items():
            for key, value in entry.items():
                for inner, one in [*enumerate(value)] if isinstance(value, list) else [(None, value)]:
                    if type(one) in (int, float) and key != "axis":
                        yield f"{block}.{name}.{key}{'' if inner is None else f'.{inner}'}", float(one)


def line_words(line: str, scene: Scene, command: str) -> list[str]:
    """The words of a command line on a scene."""
    out = scene.folder / "out"
    out.mkdir(exist_ok=True)
    own = {**scene.words, "out": str(out)}
    for made, (maker, first) in MADE.items():
        if made in line and line != first and not Path(own[made.strip("{}")]).exists():
            run_command(line_words(first, scene, maker))
    return [command, *(word.format(**own) for word in line.split())]


def wrong(done: Done, words: Sequence[str]) -> list[str]:
    """What is wrong with how a command line ended; nothing if it ended as documented."""
    found = []
    if done.returncode not in CODES:
        found.append(f"exit {done.returncode}: {done.stderr.strip()[:300]}")
    if "Traceback" in done.stderr or "Traceback" in done.stdout:
        found.append("a traceback")
    if (
        done.returncode in (2, 3, 4)
        and not done.stdout
        and "-o" not in words
        and not re.search(r"\[[a-z][a-z0-9-]*\]|Usage|usage", done.stderr)
    ):
        found.append(f"exit {done.returncode} without an error with its code: {done.stderr.strip()[:200]}")
    if done.returncode == 0 and "json" in words and "-o" not in words and done.stdout:
        try:
            json.loads(done.stdout, parse_constant=refuse)
        except ValueError as error:
            found.append(f"no JSON of finite numbers: {error}")
    elif done.returncode in (0, 1) and words[0] not in ALONE and (told := STOPPED.search(without_text(done.stdout))):
        found.append(f"a number is {told[0]}: {done.stdout[max(0, told.start() - 80) : told.end() + 20]!r}")
    return found


def refuse(constant: str) -> float:
    """Raise ValueError for NaN and infinities in JSON."""
    raise ValueError(constant)


def without_text(text: str) -> str:
    """A text without what stands in quotes or behind #."""
    return re.sub(r"'[^'\n]*'|\"[^\"\n]*\"", "", text)


def lines_of(command: str) -> Iterator[tuple[str, str]]:
    """The lines of a command, or of all."""
    for name, lines in LINES.items():
        if command in ("", name):
            yield from ((name, line) for line in lines)


def main() -> None:
    """Run the product, or a part of it; print what ends otherwise, and how often each exit code was met."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--command", default="")
    parser.add_argument("--scene", default="")
    parser.add_argument("--share", default="1/1")
    parser.add_argument("--time-limit", type=float, default=3.0)
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    part, parts = map(int, options.share.split("/"))
    codes: Counter[int] = Counter()
    faults = 0
    for place, (name, text) in enumerate(all_scenes().items()):
        if options.scene not in ("", name):
            continue
        with tempfile.TemporaryDirectory() as folder:
            scene = scene_in(Path(folder), name, text, options.time_limit)
            for number, (command, line) in enumerate(lines_of(options.command)):
                if (number + place) % parts != part - 1 or (command in ALONE and sum(codes.values()) > 2000):
                    continue
                words = line_words(line, scene, command)
                begun = time.monotonic()
                done = run_command(words)
                codes[done.returncode] += 1
                if options.verbose:
                    print(f"{done.returncode} {command} {line}: {done.stderr.strip()[:160]!r}")
                took = time.monotonic() - begun
                for what in [*wrong(done, words), *([f"took {took:.0f} s"] if took > 20 * options.time_limit else [])]:
                    faults += 1
                    print(f"{name}: heun {command} {line}: {what}", flush=True)
        print(f"# {name}: {dict(sorted(codes.items()))}, {faults} faults", flush=True)


if __name__ == "__main__":
    main()
