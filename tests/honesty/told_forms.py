"""One run in every form it is told in: CSV, tables in any units, joints' axes, against the JSON.

    python -m tests.honesty.told_forms [SPEC ...]

goes through worked examples and prints how many numbers were compared. Units are converted by a table of its own, axes
by the rotations that the JSON tells.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from heuncli.app.cli.entry import enter
from tests.shared.folders import SPECS

POUND = 0.45359237 * 9.80665  # N
SIZES = {
    "N": 1.0, "kN": 1e3, "lbf": POUND, "N·m": 1.0, "kN·m": 1e3, "kN·mm": 1.0, "N·mm": 1e-3, "lbf·in": 0.0254 * POUND,
    "rad": 1.0, "deg": math.pi / 180.0, "m": 1.0, "mm": 1e-3, "in": 0.0254, "s": 1.0,
}  # fmt: skip  # in SI
UNITS = ("", "kN,mm", "lbf,in", "N,mm", "kN")
PARTS = {"F": "force", "M": "moment"}
INSTANTS = (0.0, 0.31, 0.77)  # of the run
NUMBER = re.compile(r"-?\d+(\.\d+)?(e[+-]?\d+)?")


class Printed(NamedTuple):
    """A number of a table: joint, instant, column, value in SI, half of its last place in SI."""

    joint: str
    t: float
    column: str
    value: float
    half: float


def told(*words: str) -> str:
    """What a command prints."""
    out, raw = sys.stdout, io.BytesIO()
    sys.stdout = wrapped = io.TextIOWrapper(raw, encoding="utf-8", write_through=True)
    try:
        code = enter(["run", *words, "-q"])
    finally:
        sys.stdout = out
    wrapped.detach()
    assert code == 0, words
    return raw.getvalue().decode("utf-8")


def printed(text: str, joints: dict[str, Any]) -> Iterator[Printed]:
    """The numbers of the tables of joints, instants down, one block a joint."""
    columns: list[tuple[str, float]] = []
    joint = ""
    for line in text.splitlines():
        if not line:
            columns = []
        elif line.startswith("  t [s]"):
            columns = [(m[1], SIZES[m[2]]) for m in re.finditer(r"(\S+) \[([^\]]*)\]", line)][1:]
        elif (first := re.match(r"(\S+)  \S", line)) and first[1] in joints:
            joint = first[1]
        elif columns and line.startswith("    ") and NUMBER.match(line.strip()):
            t, *words = line.split()
            if len(words) != len(columns):
                continue  # a cell is left empty: what stands where is not looked at
            for word, (name, size) in zip(words, columns, strict=True):
                if NUMBER.fullmatch(word):
                    yield Printed(joint, float(t), name, size * float(word), size * half_of(word))


def half_of(word: str) -> float:
    """Half of a number's last printed place."""
    digits, _, power = word.partition("e")
    return 0.5 * 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))


def wanted(block: dict[str, Any], k: int, column: str) -> float | None:
    """What the JSON tells of a column of a table."""
    if column.strip("|") in PARTS:
        found = block[PARTS[column.strip("|")]][k]
        return None if None in found else math.hypot(*found)
    if column[0] in PARTS and column[1:] in ("x", "y", "z"):
        return block[PARTS[column[0]]][k]["xyz".index(column[1])]
    value = block[column][k]
    return None if value is None else float(value)


def compare_tables(spec: str, at: str, whole: dict[str, Any], units: str) -> int:
    """Every printed number is the JSON's, rounded; how many there were."""
    text = told(spec, "--only", "joints", "--at", at, *(["--units", units] if units else []))
    count = 0
    times = whole["time"]
    for one in printed(text, whole["joints"]):
        k = int(np.argmin([abs(t - one.t) for t in times]))
        exact = wanted(whole["joints"][one.joint], k, one.column)
        assert exact is not None, one
        largest = max(abs(x) for x in (exact, one.value))
        noise = 1e-14 * largest_of(whole, one.column)  # what is rounding of larger loads is told as 0
        assert abs(one.value - exact) <= one.half * (1 + 1e-9) + 1e-14 * largest + noise, (spec, units, one, exact)
        count += 1
    return count


def largest_of(whole: dict[str, Any], column: str) -> float:
    """The largest load of a sort in the JSON."""
    part = "moment" if column[0] in "Mt" else "force"
    values = [abs(x) for block in whole["joints"].values() for v in block[part] for x in v if x is not None]
    far = max(1.0, *(abs(x) for block in whole["joints"].values() for v in block["point"] for x in v if x is not None))
    forces = [abs(x) for block in whole["joints"].values() for v in block["force"] for x in v if x is not None]
    return max([*values, *(far * x for x in forces), 0.0])


def compare_csv(spec: str, at: str, whole: dict[str, Any]) -> int:
    """Every row of the CSV is a number of the JSON, to the bit, and the other way round."""
    rows = list(csv.DictReader(io.StringIO(told(spec, "--only", "joints", "--at", at, "--format", "csv"))))
    times, met = {t: k for k, t in enumerate(whole["time"])}, 0
    for row in rows:
        if row["kind"] != "joints":
            continue
        value = whole["joints"][row["name"]][row["quantity"]][times[float(row["time"])]]
        if row["component"]:
            value = value["xyz".index(row["component"])]
        assert (row["value"] == "") == (value is None), row
        assert value is None or float(row["value"]) == value, (row, value)
        met += 1
    numbers = [
        np.size(np.array(values, dtype=object))
        for block in whole["joints"].values()
        for quantity, values in block.items()
        if quantity not in ("open", "chosen")
    ]
    assert met == sum(numbers), (met, sum(numbers))
    return met


def compare_axes(spec: str, at: str, whole: dict[str, Any], rotations: dict[str, Any]) -> int:
    """In the axes of `from` and `to` forces and moments are those of the world, turned by the bodies' attitudes."""
    count = 0
    ends = {name: {"from": joint["from"], "to": joint["to"]} for name, joint in rotations["ends"].items()}
    for axes in ("from", "to"):
        other = json.loads(told(spec, "--only", "joints", "--at", at, "--axes", axes, "--format", "json"))
        for name, block in other["joints"].items():
            body = ends[name][axes]
            for k in range(len(whole["time"])):
                R = np.eye(3) if body == "ground" else np.array(rotations["bodies"][body]["rotation"][k])
                for part in PARTS.values():
                    world, own = whole["joints"][name][part][k], block[part][k]
                    if None in world or None in own:
                        continue
                    size = max(float(np.abs(world).max()), 1e-300)
                    assert np.abs(R.T @ world - own).max() <= 1e-14 * size, (spec, axes, name, k)
                    count += 3
    return count


def ends_of(spec: str) -> dict[str, dict[str, str]]:
    """The bodies at both ends of each joint."""
    from heuncli.scene.file_format.load import load

    joints = load(spec).joints
    return {joint.name: {"from": joint.a, "to": joint.b} for joint in joints.values()}


def compared(path: Path) -> int:
    """All forms of a spec's joints; how many numbers were compared."""
    spec = str(path)
    every = json.loads(told(spec, "--only", "motion,joints", "--format", "json"))
    if len(every["time"]) == 1 or not every.get("joints"):
        return 0
    end = every["time"][-1]
    at = ",".join(f"{round(share * end, 4)!r}" for share in INSTANTS)
    whole = json.loads(told(spec, "--only", "motion,joints", "--at", at, "--format", "json"))
    rotations = {"bodies": whole["bodies"], "ends": ends_of(spec)}
    count = compare_csv(spec, at, whole) + compare_axes(spec, at, whole, rotations)
    return count + sum(compare_tables(spec, at, whole, units) for units in UNITS)


def main() -> None:
    total = 0
    for path in [Path(word) for word in sys.argv[1:]] or sorted(SPECS.glob("*.yaml")):
        try:
            count = compared(path)
        except AssertionError as error:
            print(path.name, "OTHERWISE", str(error)[:400])
            continue
        total += count
        print(path.name, count)
    print(total, "numbers")


if __name__ == "__main__":
    main()
