"""Read the manual: its pages with their sections, the codes of the page on codes, and what it says on a result's path.

A path is explained by its meaning, unit, sign and frame, its error, and the command that shows it.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

from heuncli.app.cli.registry import COMMANDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import find_similar, list_words
from heuncli.results.path_words import NAMES, Node, error_kind_of_path, find_node
from heuncli.results.results_schema import ESTIMATE_OF_ERROR_KIND, IMPULSES, REPORT_OF, XYZ, Quantity

FOLDER = Path(__file__).parents[3] / "manual"
# in reading order; the pages of commands in the order of COMMANDS
PAGES = tuple(dict.fromkeys((
    "commands", "format", "howto", "elements", "python", "results", "signs", "open", "stresses", "collectives", "rest",
    *(command.page for command in COMMANDS), "accuracy", "codes", "impacts", "limits", "theory", "equations",
    "references", "decisions", "speed", "developing", "contributing", "words", "index",
)))  # fmt: skip
FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
HEADING = re.compile(r"^(#+) (.*)$", re.MULTILINE)
CONTENTS_WIDTH = 100
SECTION = re.compile(r"^### (\S+)\n\n(.*?)(?=^### |\Z)", re.MULTILINE | re.DOTALL)
ROW = re.compile(r"^\| `([a-z0-9-]+)` \| (.*?) \| (.*?) \|$", re.MULTILINE)
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


class ManualSection(NamedTuple):
    """A section of a page: from its heading to the next heading of the same or a higher level."""

    page: str
    heading: str
    level: int
    text: str

    @property
    def request(self) -> str:
        """What to type to see it; the first section of a page is the page."""
        return make_request(self.page, self.heading if self.level > 1 else "")


def make_request(page: str, heading: str = "") -> str:
    """Return what to type to see a page, or a section of it."""
    return f'heun explain "{page} {heading.lower()}"' if heading else f"heun explain {page}"


def read_page(page: str) -> str:
    """Return a page of the manual as Markdown."""
    return (FOLDER / f"{page}.md").read_text(encoding="utf-8")


def read_summary(page: str) -> str:
    """Return the subject of a page: the line below its title."""
    return read_page(page).split("\n", 3)[2]


@cache
def read_sections(page: str) -> tuple[ManualSection, ...]:
    """Return the sections of a page in their order; the first is the page itself."""
    text = read_page(page)
    plain = FENCED.sub(lambda found: "." * len(found[0]), text)  # a comment in a spec is not a heading
    headings = [(found.start(), len(found[1]), found[2]) for found in HEADING.finditer(plain)]
    ends = [
        next((start for start, other, _ in headings[number + 1 :] if other <= level), len(text))
        for number, (_, level, _) in enumerate(headings)
    ]
    return tuple(
        ManualSection(page, heading, level, text[start:end].rstrip("\n") + "\n")
        for (start, level, heading), end in zip(headings, ends, strict=True)
    )


def make_anchor(heading: str) -> str:
    """Return the anchor of a heading in links: letters, digits and hyphens, spaces as hyphens."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def find_section(page: str, name: str) -> ManualSection | None:
    """Return the section with a heading or an anchor, in any case; else the only one that begins like that."""
    anchor = make_anchor(name.strip())
    sections = read_sections(page)[1:]
    exact = next((section for section in sections if make_anchor(section.heading) == anchor), None)
    alike = [section for section in sections if anchor and make_anchor(section.heading).startswith(anchor)]
    return exact or (alike[0] if len(alike) == 1 else None)


def list_sections(page: str) -> str:
    """List the sections of a page: a line for each main section, with the sections in it."""
    lines = ["".join(_list_group(group)) for group in _group_by_main(read_sections(page)[1:])]
    wrapped = (textwrap.wrap(line, CONTENTS_WIDTH, subsequent_indent="    ", break_on_hyphens=False) for line in lines)
    head = f'Sections of this page; heun explain "{page} SECTION" shows one of them:\n\n'
    return head + "".join(f"  {line}\n" for group in wrapped for line in group)


def _group_by_main(sections: Sequence[ManualSection]) -> Iterator[Sequence[ManualSection]]:
    """Group each section of level 2 with the deeper ones in it."""
    starts = [number for number, section in enumerate(sections) if section.level == 2]
    for start, end in zip(starts, [*starts[1:], len(sections)], strict=True):
        yield sections[start:end]


def _list_group(group: Sequence[ManualSection]) -> Iterator[str]:
    """Yield the pieces of a line that lists the sections of a group."""
    main, *inner = (section.heading for section in group)
    yield main
    if inner:
        yield f": {', '.join(inner)}"


def parse_codes(page: str) -> dict[str, str]:
    """Return every code with its explanation."""
    rows = {code: f"{says}\n\nRemedy: {cure}\n" for code, says, cure in ROW.findall(page)}
    texts = rows | dict(SECTION.findall(page))
    return {code: f"# {code}\n\n" + LINK.sub(r"\1", text) for code, text in texts.items()}


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
    IMPULSES: f"as in the block of the same name; {WORLD}; forces are impulses",
}
SHAPES = {"space": "x, y, z", "cut": "one number for each cut of a series"}
# of quantities that share one row of the manual's table
MEANINGS = {
    "joints.JOINT.axial": "force along the joint's axis",
    "joints.JOINT.radial": "size of the force perpendicular to the joint's axis",
    "joints.JOINT.tilting": "magnitude of the moment perpendicular to the joint axis: tilting moment on the bearing",
    "sections.SECTION.normal": "n, normal of the cut, towards the far side",
    "sections.SECTION.first_axis": "e1, first axis in the plane of the cut; e2 = n × e1",
    "sections.SECTION.force": "force of the far side on the near side of the cut",
    "sections.SECTION.moment": "moment of the far side on the near side of the cut",
    "sections.SECTION.N": "normal force, along n; > 0 in tension",
    "sections.SECTION.Q1": "shear force along e1",
    "sections.SECTION.Q2": "shear force along e2",
    "sections.SECTION.T": "torsional moment, about n",
    "sections.SECTION.M1": "bending moment about e1",
    "sections.SECTION.M2": "bending moment about e2",
    "sections.SECTION.stress.normal_max": "largest normal stress over the section, > 0 in tension",
    "sections.SECTION.stress.normal_min": "smallest normal stress over the section, < 0 in compression",
    "sections.SECTION.stress.shear_torsion": "largest shear stress from the torsional moment alone",
    "sections.SECTION.stress.shear_mean": "shear force over area",
    "sections.SECTION.stress.shear_max": "largest shear stress from torsion and shear force together",
    "sections.SECTION.stress.mises": "largest equivalent stress (von Mises) over the section",
    "sections.SECTION.stress.utilisation": "mises over strength",
    "sections.SECTION.deflection.w1": "deflection of the bar's axis along e1, relative to its reference",
    "sections.SECTION.deflection.w2": "deflection of the bar's axis along e2, relative to its reference",
    "sections.SECTION.deflection.slope1": "slope of the deflection along e1, d/ds",
    "sections.SECTION.deflection.slope2": "slope of the deflection along e2, d/ds",
    "couplings.COUPLING.tension": "rope tension; with sheaves that grip the rope, on its first part",
    "couplings.COUPLING.last_tension": "rope tension on the last part, beyond the last sheave that grips the rope",
    "couplings.COUPLING.tight": "tension of the tight strand of a belt",
    "couplings.COUPLING.slack": "tension of the slack strand of a belt",
    "foundation.about": "point about which the moment on the ground is taken",
    "foundation.force": "total force ON the ground",
    "foundation.moment": "total moment ON the ground, about foundation.about",
    "foundation.axis.point": "point of the central axis nearest to foundation.about",
    "foundation.axis.direction": "direction of the central axis",
    "foundation.axis.pitch": "pitch of the central axis: moment over force",
    "energy.kinetic": "kinetic energy",
    "energy.potential": "potential energy of gravity, from the world's origin, and of springs",
    "energy.work": "work of all other loads and drives; kinetic + potential - work is constant",
    "impulses.NUMBER.energy_before": "kinetic energy before the impulse",
    "impulses.NUMBER.energy_after": "kinetic energy after the impulse",
    "impulses.NUMBER.energy_jump": "change of the kinetic energy at the impulse",
}


def explain_path(path: str) -> str | None:
    """Return the explanation of a path, or None if it leads to nothing; without the place along a series of cuts."""
    words = path.partition("@")[0].split(".")
    for word_count in range(len(words), 0, -1):
        for keys in _iter_keys(words[:word_count]):
            node = find_node(keys)
            if isinstance(node, Quantity) and set(words[word_count:]) <= _list_selectors(node, len(words)):
                return "".join(f"{label:<10}{text}\n" for label, text in _describe_quantity(path, keys, node))
            if node is not None and word_count == len(words) and not isinstance(node, Quantity) and len(keys) > 1:
                return f"{path}: a block of\n" + "".join(f"  {line}\n" for line in _describe_members(node))
    return None


def suggest_path(path: str) -> str:
    """Return a hint for a path that leads nowhere: the most similar one, or what stands below its block."""
    words = path.partition("@")[0].split(".")
    for word_count in range(len(words) - 1, 0, -1):
        node = find_node(words[:word_count])
        block = ".".join(words[:word_count])
        if not isinstance(node, dict):
            continue
        known = [key for key in node if key not in NAMES]
        near = find_similar(words[word_count], known)
        if near == words[word_count]:
            return f"the path ends before: heun explain {block}.{near}"
        if near is not None:
            return f"did you mean heun explain {'.'.join((block, near, *words[word_count + 1 :]))}?"
        names = [key for key in node if key in NAMES]
        return f"{block} has {list_words(known + names)}" + (f"; {names[0]} is a name of the spec" if names else "")
    return "heun explain results lists all paths"


def _list_selectors(row: Quantity, count: int) -> set[str]:
    """List the words that may follow a quantity: components of a vector, numbers in a list."""
    letters = {letter for axis in row.shape for letter in axis.letters}
    return letters | (set(map(str, range(count))) if row.shape else set())


def _iter_keys(words: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Yield the words of a path as keys; the name of a point contains a dot."""
    yield tuple(words)
    if words[0] == "points" and len(words) > 2:
        yield (words[0], f"{words[1]}.{words[2]}", *words[3:])


def _describe_quantity(path: str, keys: Sequence[str], row: Quantity) -> Iterator[tuple[str, str]]:
    """Yield label and text of each fact about a result."""
    meaning = _describe_meaning(row).replace("`", "").replace("\\|", "|")
    yield path, ""
    yield "meaning", meaning
    if row.units:
        twofold = " (translation or rotation)" if len(row.units) > 1 else ""
        yield "unit", " or ".join("none" if unit == "1" else unit for unit in row.units) + twofold
    if row.is_words:
        yield "form", "text"
        return
    if (sign := SIGNS.get(keys[0])) is not None:
        yield "sign", f"{sign}: heun explain signs"
    shape = " by ".join(SHAPES.get(axis.name, axis.name) for axis in row.shape) or "one number"
    yield "shape", shape + (" at each output time" if row.is_timed else "")
    kind = error_kind_of_path(keys[0], ".".join(keys[1:-1]), keys[-1])
    yield (
        "error",
        f"accuracy.estimate.{ESTIMATE_OF_ERROR_KIND.get(kind, kind)}, relative to the largest of its kind: "
        "heun explain accuracy",
    )
    report = REPORT_OF.get(keys[0], keys[0])
    component = f"{path}.x" if row.shape and row.shape[-1].letters == XYZ and path.split(".")[-1] not in XYZ else path
    yield "shown by", f'heun run SPEC --only {report}; heun run SPEC --measure "max {component}"'


def _describe_meaning(row: Quantity) -> str:
    """Return what a quantity is, without links."""
    return LINK.sub(r"\1", MEANINGS.get(row.path, row.meaning))


def _describe_members(node: Node) -> Iterator[str]:
    """Yield the keys of a block with their units and meanings."""
    for key, member in node.items():
        if isinstance(member, Quantity):
            unit = " or ".join(unit for unit in member.units if unit != "1") or "-"
            yield f"{key:<22}{unit:<12}{_describe_meaning(member)[:80]}"
        else:
            yield f"{key if key not in NAMES else key + ', a name':<22}..."
