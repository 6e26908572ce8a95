"""Labels are texts for readers: with them every number stays what it is, to the bit."""

from __future__ import annotations

import json
import re
import zlib
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft7Validator

from heuncli.analyses.variants.evaluation import Recipe
from heuncli.analyses.variants.keys import VariantKeys
from heuncli.base.errors import SpecError
from heuncli.output.tables.export import to_csv, to_json
from heuncli.scene.file_format.incremental_loader import SpecVariants
from heuncli.scene.file_format.json_schema import make_spec_schema
from heuncli.scene.file_format.labels import BLOCKS, GROUND
from heuncli.scene.file_format.load import load, load_with_cases
from heuncli.scene.file_format.models import Logo, ReportSettings, Spec
from heuncli.scene.file_format.source import read_source
from heuncli.study.model.options import Options
from heuncli.study.quantities.labels import make_labels
from heuncli.study.workflow import solve
from tests.shared.folders import ROOT

SPECS = sorted((ROOT / "specs").glob("*.yaml"))
SOLVED = ("double", "engine", "axle_loads", "bouncing_ball")


def label_everything(data: dict[str, Any]) -> tuple[dict[str, Any], dict[str, str]]:
    """The data with a label on whatever has a name, and the labels that are to be read."""
    labels: dict[str, str] = {GROUND: "Test bench"}
    found = json.loads(json.dumps(data))

    def name(path: str) -> str:
        return labels.setdefault(path, f"Label of {path.replace('.', ' ')} <&>")

    def label_points(owner: dict[str, Any], words: str) -> None:
        for point, place in owner.get("points", {}).items():
            owner["points"][point] = {"label": name(f"points.{words}.{point}"), "at": place}

    for block, kept in BLOCKS.items():
        for entry_name, entry in (found.get(block) or {}).items():
            label = name(f"{kept}.{entry_name}")
            if block == "parameters":
                found[block][entry_name] = {"value": entry, "label": label}
            else:
                entry["label"] = label
            if block == "bodies":
                label_points(entry, entry_name)
    found["ground"] = {**(found.get("ground") or {}), "label": "Test bench"}
    label_points(found["ground"], "ground")
    events = found.get("analysis", {}).get("events", {})
    for event, condition in events.items():
        label = name(f"events.{event}")
        events[event] = (
            {**condition, "label": label} if isinstance(condition, dict) else {"when": condition, "label": label}
        )
    return found, labels


def numbers(spec: Spec) -> str:
    """What a scene is, without its labels, its titles, its digest and the places in its file."""
    bare = spec._replace(labels={}, title="", cases={}, sha256="", locations={}, warnings=(), expect=())
    bare = bare._replace(tables={name: table.name for name, table in spec.tables.items()})  # type: ignore[arg-type]
    return re.sub(r"line=\d+, column=\d+", "", repr(bare))


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
@pytest.mark.sixth
def test_labels_on_everything_change_no_scene(path: Path) -> None:
    data, labels = label_everything(read_source(str(path), None).data)
    plain, plain_cases = load_with_cases(str(path))
    labelled, cases = load_with_cases(str(path), text=json.dumps(data))
    assert dict(labelled.labels) == labels
    assert not plain.labels
    assert numbers(labelled) == numbers(plain)
    assert [numbers(case) for case in cases.values()] == [numbers(case) for case in plain_cases.values()]
    assert Draft7Validator(SCHEMA).is_valid(data)


SCHEMA = make_spec_schema()


@pytest.mark.heavy
@pytest.mark.parametrize("name", SOLVED)
@pytest.mark.third
def test_labels_change_no_result(name: str) -> None:
    """JSON differs by the block of labels alone, CSV not at all."""
    path = str(ROOT / "specs" / f"{name}.yaml")
    data, labels = label_everything(read_source(path, None).data)
    specs = [load(path), load(path, json.dumps(data))]
    results = [solve(spec, Options()).results for spec in specs]
    plain, labelled = (json.loads(to_json(each)) for each in results)
    assert labelled.pop("labels") == labels
    for block in (plain, labelled):
        del block["work"], block["spec"]
    assert labelled == plain
    assert to_csv(results[0], make_labels(specs[0])) == to_csv(results[1], make_labels(specs[1]))


def test_variants_ignore_labels() -> None:
    """A stored variant is found again after labels and the head of the report were written."""
    path = str(ROOT / "specs" / "engine.yaml")
    data = read_source(path, None).data
    labelled = {**label_everything(data)[0], "report": {"company": "ACME", "results": data["report"]}}
    parameter = next(name for name, value in data["parameters"].items() if isinstance(value, int | float | str))
    texts = (json.dumps(data), json.dumps(labelled))
    keys = [VariantKeys(Recipe(path, text, (), Options(), {}), varies_cases=False).make_spec_key() for text in texts]
    assert keys[0] == keys[1]
    variants = [SpecVariants(path, text).load({parameter: "0.123"}) for text in texts]
    bare = [variant._replace(report=ReportSettings(results=variant.report.results)) for variant in variants]
    assert numbers(bare[0]) == numbers(bare[1])
    assert variants[1].labels == load(path, texts[1]).labels


REPORT = (
    "report: {company: A & B, project: P, author: N. N., revision: C, part: 4-711, logo: logo.svg, "
    "chapters: [open, loads], results: [motion]}"
)
BODY = "bodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [1, 0, 0]}%s}}"


def problems(text: str) -> list[tuple[str, str, str]]:
    with pytest.raises(SpecError) as caught:
        load(str(ROOT / "specs" / "broken" / "x.yaml"), f"heun: 1\n{text}\n")
    return [(p.location.path if p.location else "", p.code, p.hint or "") for p in caught.value.problems]


@pytest.mark.parametrize(
    ("text", "path", "code"),
    [
        (BODY % ", label: 3", "bodies.b.label", "wrong-kind"),
        (BODY % ", label: ''", "bodies.b.label", "bad-label"),
        (BODY % ', label: "a\\u202eb"', "bodies.b.label", "bad-label"),
        (BODY % f", label: {'x' * 81}", "bodies.b.label", "bad-label"),
        (BODY % ", lable: Body", "bodies.b.lable", "unknown-key"),
        (BODY % "" + "\nparameters: {L: {valeu: 1, label: Length}}", "parameters.L.valeu", "unknown-key"),
        (BODY % "" + "\nparameters: {L: {value: x, label: Length}}", "parameters.L", "unknown-name"),
        (BODY % "" + "\nground: {points: {O: {at: [0, y, 0], label: Origin}}}", "ground.points.O.1", "unknown-name"),
        (BODY % "" + "\nanalysis: {events: {e: {when: 2, label: Event}}}", "analysis.events.e", "condition"),
        (BODY % "" + "\nreport: {author: '', company: ACME}", "report.author", "bad-label"),
        (BODY % "" + "\nreport: {chapters: [laods]}", "report.chapters.0", "unknown-word"),
        (BODY % "" + "\nreport: {logo: none.svg}", "report.logo", "logo-file"),
        (BODY % "" + "\nreport: {logo: wedge.obj}", "report.logo", "logo-file"),
        (BODY % "" + "\nreport: {results: [joint]}", "report.results.0", "unknown-word"),
    ],
)
def test_what_is_wrong_is_told_at_its_place(text: str, path: str, code: str) -> None:
    assert [(where, what) for where, what, _ in problems(text)] == [(path, code)]


def test_hints_name_the_key() -> None:
    assert problems(BODY % ", lable: Body")[0][2] == "did you mean label?"
    assert "did you mean loads?" in problems(BODY % "" + "\nreport: {chapters: [laods]}")[0][2]


def test_a_label_may_be_set() -> None:
    """By --set and by a load case, as any other key."""
    text = f"heun: 1\n{BODY % ''}\ncases: {{heavy: {{label: Heavy load, set: {{bodies.b.label: Ballast}}}}}}\n"
    spec, cases = load_with_cases("x.yaml", text=text)
    assert dict(spec.labels) == {"cases.heavy": "Heavy load"}
    assert dict(cases["heavy"].labels) == {"cases.heavy": "Heavy load", "bodies.b": "Ballast"}
    assert cases["heavy"].title == "(case heavy: Heavy load)"
    set_labels = load("x.yaml", text, {"bodies.b.label": "Body"}).labels
    assert set_labels["bodies.b"] == "Body"
    with pytest.raises(SpecError) as caught:
        load("x.yaml", text, {"bodies.b.label": "[1]"})
    (problem,) = caught.value.problems
    assert (problem.code, problem.location and problem.location.file) == ("wrong-kind", "--set bodies.b.label=[1]")


def test_the_head_of_a_report_is_read(tmp_path: Path) -> None:
    (tmp_path / "logo.svg").write_text("<?xml version='1.0'?><!-- x --><svg xmlns='http://www.w3.org/2000/svg'/>")
    text = f"heun: 1\n{BODY % ''}\n{REPORT}\n"
    found = load(tmp_path / "s.yaml", text).report
    logo = Logo("logo.svg", (tmp_path / "logo.svg").read_bytes(), "image/svg+xml")
    assert found == ReportSettings("A & B", "P", "N. N.", "C", "4-711", logo, ("open", "loads"), ("motion",))
    assert load("x.yaml", f"heun: 1\n{BODY % ''}\nreport: [motion]\n").report == ReportSettings(results=("motion",))


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "no element found"),
        (b"<html/>", "<html>"),
        (b"<svg>", "no element found"),
        (b"<!DOCTYPE svg [<!ENTITY a 'b'>]><svg>&a;</svg>", "entities"),
        (b"\x89PNG\r\n\x1a\n", "too early"),
        (b"\x89PNG\r\n\x1a\n" + b"\0" * 40, "damaged"),
        (b"<svg>" + b" " * 1_000_001 + b"</svg>", "1 MB"),
    ],
)
def test_a_logo_is_a_picture(tmp_path: Path, content: bytes, reason: str) -> None:
    (tmp_path / "logo").write_bytes(content)
    with pytest.raises(SpecError) as caught:
        load(tmp_path / "s.yaml", f"heun: 1\n{BODY % ''}\nreport: {{logo: logo}}\n")
    (problem,) = caught.value.problems
    assert problem.code == "logo-file"
    assert reason in problem.message


def chunk(name: bytes, content: bytes) -> bytes:
    """A chunk of a PNG file."""
    return len(content).to_bytes(4, "big") + name + content + zlib.crc32(name + content).to_bytes(4, "big")


def test_a_png_is_a_logo(tmp_path: Path) -> None:
    header = chunk(b"IHDR", bytes([0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0]))
    whole = b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(b"\0\0")) + chunk(b"IEND", b"")
    (tmp_path / "logo.png").write_bytes(whole)
    text = f"heun: 1\n{BODY % ''}\nreport: {{logo: logo.png}}\n"
    logo = load(tmp_path / "s.yaml", text).report.logo
    assert logo is not None
    assert (logo.media_type, logo.content) == ("image/png", whole)
    (tmp_path / "logo.png").write_bytes(whole[:-12])
    with pytest.raises(SpecError, match="too early"):
        load(tmp_path / "s.yaml", text)
