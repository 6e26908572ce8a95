"""What a page holds of every spec: the numbers of the JSON at the same instants, and places that are drawn."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.app.commands.show import REPORTS
from heuncli.output.machine_geometry.poses import compute_poses
from heuncli.output.tables.export import to_json
from heuncli.output.web_page.geometry import make_page_machine
from heuncli.output.web_page.moving_page import render_moving_page
from heuncli.output.web_page.packing import NUMBER_STEPS
from heuncli.output.web_page.page_numbers import ZERO_ROWS_PREFIX
from heuncli.results.path_words import split_leading_key
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.measure import find_peak
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.shared.folders import SPECS
from tests.shared.moving_pages import data_of, places, unpacked

pytestmark = pytest.mark.heavy
FILES = sorted(SPECS.glob("*.yaml"))
ANY = pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
PIXEL = 1e-5  # of a scene's reach: far below a pixel


@cache
def shown(file: Path) -> tuple[Study, str]:
    """A spec solved, and its page."""
    study = solve(load(file, checking=False), Options(requested_reports=REPORTS))
    return study, render_moving_page({"": study}, Units())


def told(document: Any, path: str) -> Any:
    """What stands in the JSON at a path."""
    words = path.split(".")
    while words:
        key, words = split_leading_key(document, words)
        document = document[key]
    return document


def rows(data: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """All rows over the frames."""
    return (row for block in data["blocks"] for group in block["groups"] for row in group["rows"])


def numbers(values: Any) -> Array:
    """Of a list of the JSON, null as nan."""
    return np.array(values, dtype=np.float64)


def assert_same(column: Array, found: Array, wanted: Array, path: str) -> None:
    """Numbers of a page are those of the JSON to half a step of the largest of their column, four digits of which are
    shown; open ones are open.
    """
    half = 0.5 / NUMBER_STEPS * float(np.nanmax(np.abs(column), initial=0.0))
    np.testing.assert_allclose(found, wanted, rtol=6e-8 * np.isnan(column).any(), atol=half * (1 + 1e-6), err_msg=path)


@ANY
@pytest.mark.sixth
def test_the_numbers_are_those_of_the_json(file: Path) -> None:
    study, page = shown(file)
    data, document = data_of(page), json.loads(to_json(study.results))
    count = data["count"]
    times = unpacked(data["time"], count)
    assert np.all(np.diff(times) > 0.0) and len(times) == count
    frames = np.flatnonzero(np.isin(times, study.results.time))
    asked = np.searchsorted(study.results.time, times[frames])
    assert len(frames) == min(len(study.results.time), count)
    seen = 0
    for row in rows(data):
        found = np.stack([unpacked(packed, count) for _, packed, _ in row["parts"]], axis=1)
        wanted = numbers(told(document, row["path"])).reshape(len(study.results.time), -1)
        assert_same(found, found[frames], wanted[asked], row["path"])
        seen += found.size
    for section in data["sections"]:
        for load_ in section["loads"]:
            found = unpacked(load_["values"], count * len(section["cuts"])).reshape(count, -1)
            wanted = numbers(told(document, load_["path"])).reshape(len(study.results.time), -1)
            assert_same(found, found[frames], wanted[asked], load_["path"])
            seen += found.size
    for block in (block for impulse in data["impulses"] for block in impulse["blocks"]):
        for row in (row for group in block["groups"] for row in group["rows"]):
            found = np.array([unpacked(packed, 1)[0] for _, packed, _ in row["parts"]])
            assert_same(found, found, _impulse_numbers(document, row["path"]), row["path"])
            seen += found.size
    assert seen > 0


def _impulse_numbers(document: Any, path: str) -> Array:
    """The numbers of an impulse in the JSON, at a path."""
    _, number, rest = path.split(".", 2)
    return numbers(told(document["impulses"][int(number)], rest)).reshape(-1)


@ANY
@pytest.mark.sixth
def test_what_is_0_throughout_is_named(file: Path) -> None:
    """Nothing of joints, foundation and sections is missing without a word."""
    study, page = shown(file)
    data = data_of(page)
    there = {row["path"] for row in rows(data)}
    said = [
        name
        for block in data["blocks"]
        for note in block["notes"]
        for name in note[len(ZERO_ROWS_PREFIX) :].split(", ")
    ]
    for name, joint in study.results.joints.items():
        for quantity in ("force", "moment"):
            if quantity in joint:
                assert f"joints.{name}.{quantity}" in there or f"{name} {quantity}" in said


@ANY
@pytest.mark.sixth
def test_the_poses_are_those_of_the_machine(file: Path) -> None:
    study, page = shown(file)
    data = data_of(page)
    scene, count = data["scene"], data["count"]
    poses, machine = (
        compute_poses(study, unpacked(data["time"], count)),
        make_page_machine(study.spec, study.setup.scene),
    )
    half, center = np.array(scene["half"]), np.array(scene["center"])
    for body, look in zip(scene["bodies"], machine.bodies, strict=True):
        at = places(body["places"]).reshape(count, 3)
        np.testing.assert_allclose(at, poses.positions[look.name], rtol=1e-6, atol=PIXEL * scene["radius"])
        w, x, y, z = places(body["attitudes"]).reshape(count, 4).T
        first = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=1)
        np.testing.assert_allclose(first, poses.orientations[look.name][:, :, 0], atol=1e-5)
        clouds = [surface.corners for surface in look.surfaces] + list(look.strokes)
        drawn = [places(s["corners"]) if "corners" in s else None for s in body["surfaces"]]
        drawn += [places(x) for x in (*body["bars"], *body["lines"])]
        for wanted, found in zip(clouds, drawn, strict=True):
            if found is not None:
                np.testing.assert_allclose(found.reshape(-1, 3), wanted, rtol=1e-6, atol=PIXEL * scene["radius"])
            stand = poses.locate_points(look.name, wanted, 0)
            assert np.all(np.abs(stand - center) <= half * (1 + 1e-9) + 1e-9 * scene["radius"])


def test_a_belts_strands_touch_both_pulleys() -> None:
    """A strand is as far from each axle as the belt's radius there, and stands on the ground, which carries both."""
    study, page = shown(SPECS / "belt_drive.yaml")
    (belt,) = (own for own in study.spec.couplings.values() if own.type == "belt")
    (drawn,) = data_of(page)["scene"]["belts"]
    assert drawn["body"] == -1
    for begin, end in places(drawn["strands"]).reshape(2, 2, 3)[..., :2]:
        way = (end - begin) / np.linalg.norm(end - begin)
        for term, radius in zip(belt.terms, belt.radii, strict=True):
            x, y = np.array(study.spec.joints[term.joint].p)[:2] - begin
            assert abs(abs(way[0] * y - way[1] * x) - radius) < PIXEL


@ANY
@pytest.mark.sixth
def test_cuts_stand_where_the_results_say(file: Path) -> None:
    study, page = shown(file)
    data = data_of(page)
    machine, poses = make_page_machine(study.spec, study.setup.scene), compute_poses(study, study.results.time)
    for section in data["sections"]:
        block, name = study.results.sections[section["name"]], machine.bodies[section["body"]].name
        if study.spec.sections[section["name"]].reduce_to == "at":
            found = poses.locate_points(name, np.array(section["cuts"]), 0)
            np.testing.assert_allclose(found, block["point"][0].reshape(-1, 3), atol=1e-9 * data["scene"]["radius"])
        for axis, wanted in (("normal", block["normal"][0]), ("first", block["first_axis"][0])):
            turned = poses.orientations[name][0] @ np.array(section[axis])
            np.testing.assert_allclose(turned, wanted, atol=1e-12)
        e = np.array([section["first"], section["second"], section["normal"]])
        np.testing.assert_allclose(e @ e.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(e) > 0.0


@pytest.mark.parametrize("name", ["double", "engine", "jib", "whirling_rod", "hammered_four_bar", "compressor"])
@pytest.mark.third
def test_no_largest_load_is_missed(name: str) -> None:
    """Among the frames are those at which a search between the samples finds a load largest."""
    study, page = shown(SPECS / f"{name}.yaml")
    data = data_of(page)
    count, looked = data["count"], 0
    for row in rows(data):
        if row["path"].split(".")[0] in ("joints", "foundation") and row["label"] == "force":
            if len(row["path"].split(".")) > 3:
                continue
            vectors = np.stack([unpacked(packed, count) for _, packed, _ in row["parts"]], axis=1)
            found, wanted = float(np.sqrt((vectors**2).sum(axis=1)).max()), find_peak(study, row["path"], "max").value
            assert found == pytest.approx(wanted, rel=1e-6), row["path"]
            looked += 1
    for section in data["sections"]:
        for load_ in section["loads"]:
            values = np.abs(unpacked(load_["values"], count * len(section["cuts"])))
            assert values.max() <= abs(find_peak(study, load_["path"], "abs").value) * (1 + 1e-9)
    assert looked > 0


@pytest.mark.parametrize("name", ["double", "crane", "percussion", "table"])
def test_the_bytes_repeat(name: str) -> None:
    file = SPECS / f"{name}.yaml"
    again = render_moving_page({"": solve(load(file, checking=False), Options(requested_reports=REPORTS))}, Units())
    assert again == shown(file)[1]


def test_the_page_of_two_bars_is_small() -> None:
    assert len(shown(SPECS / "double.yaml")[1].encode()) <= 300_000
