"""Explain a path of the results: meaning, unit, sign and frame, error, and which command shows it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from heuncli.results.results_schema import (
    ESTIMATE_OF_ERROR_KIND,
    IMPULSES,
    NAMES,
    REPORT_OF,
    XYZ,
    Node,
    Quantity,
    error_kind_of_path,
    find_node,
)

LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")
WORLD = "components in world axes"
# by block: on which body it acts, about which point, in which axes; details on the manual page "signs"
SIGNS = {
    "joints": f"reaction of `from` ON `to`, moments about the `to` point; {WORLD}, or --axes from, to",
    "foundation": f"force of the machine ON the ground, moments about foundation.about; {WORLD}",
    "sections": "force of the far side (normal points into it) ON the near side of the cut; N > 0 tension",
    "stops": "force of the stop ON `to`, along the coordinate that it limits",
    "forces": "as in the spec: > 0 along its vector, or pushing its two points apart",
    "coordinates": "motion of `to` relative to `from`, about or along the joint's axis, right-handed",
    "bodies": WORLD,
    "points": WORLD,
    "momentum": f"{WORLD}; moments about foundation.about",
    "system_vector": WORLD,
    IMPULSES: f"as in the block of the same name; {WORLD}; forces are impulses there",
}


def explain_path(path: str) -> str | None:
    """Return the explanation of a path, or None if it leads to nothing."""
    words = path.split(".")
    for word_count in range(len(words), 0, -1):
        for keys in _iter_keys(words[:word_count]):
            node = find_node(keys)
            if isinstance(node, Quantity) and set(words[word_count:]) <= {*XYZ, *map(str, range(len(words)))}:
                return "".join(f"{label:<9}{text}\n" for label, text in _describe_quantity(path, keys, node))
            if node is not None and word_count == len(words) and not isinstance(node, Quantity) and len(keys) > 1:
                return f"{path}: a block of\n" + "".join(f"  {line}\n" for line in _describe_members(node))
    return None


def _iter_keys(words: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Yield the words of a path as keys; the name of a point contains a dot."""
    yield tuple(words)
    if words[0] == "points" and len(words) > 2:
        yield (words[0], f"{words[1]}.{words[2]}", *words[3:])


def _describe_quantity(path: str, keys: Sequence[str], row: Quantity) -> Iterator[tuple[str, str]]:
    meaning = LINK.sub(r"\1", row.meaning).replace("`", "").replace("\\|", "|")
    yield path, ""
    yield "meaning", meaning
    if row.units:
        twofold = " (translation or rotation)" if len(row.units) > 1 else ""
        yield "unit", " or ".join(row.units).replace("1", "none") + twofold
    if row.is_words:
        yield "form", "text"
        return
    if (sign := SIGNS.get(keys[0])) is not None:
        yield "sign", f"{sign}: heun explain signs"
    shape = " by ".join("x, y, z" if axis.letters == XYZ else axis.name for axis in row.shape) or "one number"
    yield "shape", shape + (" at each instant" if row.is_timed else "")
    kind = error_kind_of_path(keys[0], ".".join(keys[1:-1]), keys[-1])
    yield (
        "error",
        f"accuracy.estimate.{ESTIMATE_OF_ERROR_KIND.get(kind, kind)}, relative to the largest of its kind: "
        "heun explain accuracy",
    )
    report = REPORT_OF.get(keys[0], keys[0])
    component = f"{path}.x" if row.shape and row.shape[-1].letters == XYZ and path.split(".")[-1] not in XYZ else path
    yield "shown by", f'heun run SPEC --only {report}; heun run SPEC --measure "max {component}"'


def _describe_members(node: Node) -> Iterator[str]:
    """Yield the keys of a block with their units and meanings."""
    for key, member in node.items():
        if isinstance(member, Quantity):
            unit = " or ".join(member.units).replace("1", "") or "-"
            meaning = LINK.sub(r"\1", member.meaning)
            yield f"{key:<22}{unit:<12}{meaning[:80]}"
        else:
            yield f"{key if key not in NAMES else key + ', a name':<22}..."
