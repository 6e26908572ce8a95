"""What stands at a path of the results: meaning, unit, sign and frame, its error, and how it is told."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from heuncli.results.results_schema import BLOWS, KIND_OF, NAMES, REPORT_OF, XYZ, Node, Quantity, kind_of_error, under

LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")
WORLD = "components in world axes"
# by block: on whom it acts, about which point, in which axes; the whole of it stands on the page of signs
SIGNS = {
    "joints": f"of `from` ON `to`, moments about the `to` point; {WORLD}, or --axes from, to",
    "foundation": f"of the machine ON the ground, moments about foundation.about; {WORLD}",
    "sections": "of the piece that the normal points into ON the remainder; N along the normal, > 0 where it pulls",
    "stops": "of the stop ON `to`, along the coordinate that it limits",
    "forces": "as in the spec: > 0 along its vector, or where it pushes its two points apart",
    "coordinates": "of `to` against `from`, about or along the joint's axis, right-handed",
    "bodies": WORLD,
    "points": WORLD,
    "momentum": f"{WORLD}; moments about foundation.about",
    "system_vector": WORLD,
    BLOWS: f"as in the block of the same name; {WORLD}; forces are impulses there",
}


def explained(path: str) -> str | None:
    """What stands at a path; None where it leads to nothing."""
    words = path.split(".")
    for last in range(len(words), 0, -1):
        for keys in _spellings(words[:last]):
            found = under(keys)
            if isinstance(found, Quantity) and set(words[last:]) <= {*XYZ, *map(str, range(len(words)))}:
                return "".join(f"{label:<9}{text}\n" for label, text in _of_quantity(path, keys, found))
            if found is not None and last == len(words) and not isinstance(found, Quantity) and len(keys) > 1:
                return f"{path}: a block of\n" + "".join(f"  {line}\n" for line in _members(found))
    return None


def _spellings(words: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """The words as keys; the name of a point holds a dot."""
    yield tuple(words)
    if words[0] == "points" and len(words) > 2:
        yield (words[0], f"{words[1]}.{words[2]}", *words[3:])


def _of_quantity(path: str, keys: Sequence[str], row: Quantity) -> Iterator[tuple[str, str]]:
    meaning = LINK.sub(r"\1", row.meaning).replace("`", "").replace("\\|", "|")
    yield path, ""
    yield "meaning", meaning
    if row.units:
        twofold = ", of what slides or of what turns" if len(row.units) > 1 else ""
        yield "unit", " or ".join(row.units).replace("1", "none") + twofold
    if row.is_words:
        yield "form", "words"
        return
    if (sign := SIGNS.get(keys[0])) is not None:
        yield "sign", f"{sign}: heun explain signs"
    shape = " by ".join("x, y, z" if axis.letters == XYZ else axis.name for axis in row.shape) or "one number"
    yield "shape", shape + (" at each instant" if row.timed else "")
    kind = kind_of_error(keys[0], ".".join(keys[1:-1]), keys[-1])
    yield "error", f"accuracy.estimate.{KIND_OF.get(kind, kind)}, of the largest of its kind: heun explain accuracy"
    report = REPORT_OF.get(keys[0], keys[0])
    component = f"{path}.x" if row.shape and row.shape[-1].letters == XYZ and path.split(".")[-1] not in XYZ else path
    yield "told by", f'heun run SPEC --only {report}; heun run SPEC --measure "max {component}"'


def _members(node: Node) -> Iterator[str]:
    """The keys of a block with their units and meanings."""
    for key, member in node.items():
        if isinstance(member, Quantity):
            unit = " or ".join(member.units).replace("1", "") or "-"
            meaning = LINK.sub(r"\1", member.meaning)
            yield f"{key:<22}{unit:<12}{meaning[:80]}"
        else:
            yield f"{key if key not in NAMES else key + ', a name':<22}..."
