"""The scripts of a page without a page: digits as tables have them, views that are rigid, frames by their instants.

Run by Node, where there is one; a browser runs all of them in tests/browser.
"""

from __future__ import annotations

import json
import math
import shutil
import subprocess
from typing import Any

import numpy as np
import pytest

from heuncli.base.joint_kinds import TYPES
from heuncli.output.web_page.moving_page import bundle_scripts, sort_scripts
from heuncli.study.quantities.digits import Style

NODE = shutil.which("node")
pytestmark = [
    pytest.mark.heavy,
    pytest.mark.skipif(NODE is None, reason="no Node on this machine: scripts of pages are not run without a browser"),
]
CORNERS = [[1.0 + x, 2.0 + 0.5 * y, 3.0 + 2.0 * z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
SCENE = {"center": [1.0, 2.0, 3.0], "radius": 2.5, "joints": [], "ground": [], "cloud": CORNERS}


def run(code: str, given: Any) -> Any:
    """What a piece of script returns of what it is given, with all scripts but the last before it."""
    text = bundle_scripts()
    begun = text[: text.index(f"const {sort_scripts()[-1]}_js")]
    whole = f"{begun}\nconsole.log(JSON.stringify(((given) => {{ {code} }})({json.dumps(given)})));\n}})();\n"
    done = subprocess.run([str(NODE), "-"], input=whole, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_numbers_have_the_digits_of_tables() -> None:
    random = np.random.default_rng(5)
    cases: list[tuple[float, Style]] = []
    for _ in range(2000):
        scale = 10.0 ** random.uniform(-9, 12)
        how = Style(
            5 - math.floor(math.log10(scale)) - int(random.integers(4)), bool(random.integers(2)),
            scale * 10.0 ** random.uniform(-9, -3),
            bool(random.uniform() < 0.9),
        )  # fmt: skip
        cases.append((float(scale * random.normal()), how))
    cases += [(0.0, Style(3)), (-0.00049, Style(3)), (1e-300, Style(5, True))]
    found = run(
        "return given.map(([value, style]) => digits_js.formatNumber(value, style));", [[v, list(s)] for v, s in cases]
    )
    wanted = [how.write(value) for value, how in cases]
    # an exponent is written as each of the two languages does: 1e+07, 1e+7
    plain = [text.replace("−", "-") if "e" not in text else float(text.replace("−", "-")) for text in found]
    assert plain == [text if "e" not in text else float(text) for text in wanted]


def test_what_is_open_is_told() -> None:
    code = "return [NaN, -Infinity].map((value) => digits_js.formatNumber(value, [3, false, 0, true]));"
    assert run(code, None) == ["open", "unbounded"]


@pytest.mark.parametrize("gravity", [[0, 0, -9.81], [0, -9.81, 0], [9.81, 0, 0], [0, 0, 0]])
@pytest.mark.parametrize("normal", [None, [0, 0, 1], [1, 0, 0], [0, -1, 0]])
@pytest.mark.third
def test_a_view_is_rigid_and_up_is_up(gravity: list[float], normal: list[float] | None) -> None:
    code = """
      const view = new view_js.View(given);
      view.resize(800, 600);
      const found = [[view.right, view.above, view.toward]];
      for (const axis of [[1, 0, 0], [0, 1, 0], [0, 0, 1]]) {
        view.lookAlong(axis);
        found.push([view.right, view.above, view.toward]);
      }
      view.turn(0.7, -0.4);
      found.push([view.right, view.above, view.toward]);
      return [found, view.up];
    """
    found, up = run(code, SCENE | {"gravity": gravity, "normal": normal})
    for axes in np.array(found):
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(axes) == pytest.approx(1.0)
        assert axes[1] @ np.array(up) >= -1e-12
    if any(gravity):
        np.testing.assert_allclose(up, -np.array(gravity) / 9.81)
    for k, axes in enumerate(np.array(found[1:4])):  # along an axis: what goes to the right is a positive axis
        assert abs(axes[2][k]) == pytest.approx(1.0) and axes[0].max() == pytest.approx(1.0)


def test_all_of_a_machine_is_on_the_screen() -> None:
    code = """
      const view = new view_js.View(given);
      const found = [];
      for (const [w, h] of [[800, 600], [390, 300], [300, 900]]) {
        view.resize(w, h);
        for (const corner of given.cloud) {
          const [x, y] = view.project(corner);
          found.push([x / w, y / h]);
        }
      }
      return found;
    """
    found = np.array(run(code, SCENE | {"gravity": [0, 0, -9.81], "normal": None}))
    assert found.min() > 0.0 and found.max() < 1.0
    for screen in found.reshape(3, 8, 2):  # it fills its canvas in one direction
        assert np.ptp(screen, axis=0).max() > 0.75


def test_frames_are_found_by_their_instants() -> None:
    code = """
      globalThis.matchMedia = () => ({ matches: false });
      const player = new player_js.Player(given, () => {});
      const before = [-1, 0, 0.1, 0.25, 0.3, 9].map((t) => player.findFrame(t));
      return [before, [0.04, 0.06, 0.19, 9].map((t) => player.findNearestFrame(t))];
    """
    assert run(code, [0.0, 0.1, 0.3, 0.4]) == [[0, 0, 1, 1, 2, 3], [0, 1, 1, 3]]


def test_a_run_is_proposed_at_a_speed_at_which_it_is_seen() -> None:
    durations = [0.05, 0.08, 2.0, 36.0, 5000.0, 1e-9]
    found = run("return given.map((duration) => player_js.proposeSpeed(duration));", durations)
    assert found == [0.01, 0.01, 1, 1, 100, 0.0001]


def test_a_pose_between_two_frames_is_one_of_a_rigid_body() -> None:
    half = math.sin(0.1), math.cos(0.1)
    code = """
      const scene = { bodies: given.map((attitudes) => ({ places: [0, 0, 0, 1, 2, 3], attitudes })) };
      return [0, 0.5, 1].map((share) => poses_js.computePoses(scene, 0, share));
    """
    near = [1.0, 0.0, 0.0, 0.0, half[1], 0.0, 0.0, half[0]]
    far = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    for share, (smooth, torn) in zip((0.0, 0.5, 1.0), run(code, [near, far]), strict=True):
        R = np.array(smooth["R"]).reshape(3, 3)
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert math.atan2(R[1, 0], R[0, 0]) == pytest.approx(0.2 * share)
        np.testing.assert_allclose(smooth["place"], share * np.array([1.0, 2.0, 3.0]))
        np.testing.assert_array_equal(torn["place"], [0.0, 0.0, 0.0])  # it turns too far to be drawn between


def test_the_envelope_holds_every_curve_and_reaches_no_farther() -> None:
    code = """
      const runs = given.map(([x, values, size], run) => ({
        axes: [{ label: "angle", values: x }],
        histories: [{ path: "p", make: () => ({ path: "p", size, low: values, high: values }) }],
      }));
      const own = histories_js.computeHistory(runs[0].histories[0]);
      const { values, low, high, greatest, least } = histories_js.computeEnvelope(runs, own, { label: "angle" });
      return [[...values], [...low], [...high], [greatest.run, greatest.value, least.run, least.value]];
    """
    random = np.random.default_rng(11)
    curves = []
    for n, end in ((40, 5.0), (31, 7.0), (25, 3.0)):
        x = np.sort(random.uniform(0.0, end, n))
        curves.append((x, np.sin(x) * random.uniform(0.5, 2.0) + random.normal(size=n)))
    falling = (curves[2][0][::-1], curves[2][1][::-1])  # an angle that goes back, and a case told in another unit
    given = [[x.tolist(), y.tolist(), 1.0] for x, y in curves[:2]] + [
        [falling[0].tolist(), (1e-3 * falling[1]).tolist(), 1e-3]
    ]
    grid, low, high, (worst, most, best, least) = run(code, given)
    np.testing.assert_array_equal(grid, np.unique(np.concatenate([x for x, _ in curves])))
    each = np.array([np.interp(grid, x, y, left=np.nan, right=np.nan) for x, y in curves])
    np.testing.assert_allclose(low, np.nanmin(each, axis=0), rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(high, np.nanmax(each, axis=0), rtol=1e-12, atol=1e-14)
    greatest = [y.max() for _, y in curves]
    smallest = [y.min() for _, y in curves]
    assert (worst, best) == (int(np.argmax(greatest)), int(np.argmin(smallest)))
    assert (most, least) == pytest.approx((max(greatest), min(smallest)))


def test_a_section_load_that_is_open_is_shown_as_open() -> None:
    code = """
      const base = { style: [3, false, 0, true], size: 1, unit: "N" };
      const [a, b, c, d] = given.map((rows) => rows.map((value) => value ?? NaN));
      const loads = [a, b, c, d].map((values, k) => ({ ...base, label: k < 2 ? "N" : "M1", caption: `c${k}`, path: "p",
        values: Float64Array.from(values) }));
      return loads.map((load) => {
        const section = { cuts: [0, 1], loads: [load] };
        const [{ at, frame, value, size }] = summary_js.makeSectionEntries(section, 2);
        return [digits_js.formatNumber(at(0), load.style), digits_js.formatNumber(at(1), load.style), frame,
          digits_js.formatNumber(value, load.style), size];
      });
    """
    given = [[None, None, None, None], [None, None, 1, -2], [None, 3, 0, 0], [None, None, 0, 0]]
    assert run(code, given) == [
        ["open", "open", 0, "open", 0],
        ["open", "−2.000", 1, "−2.000", 2],
        ["3.000", "0", 0, "3.000", 3],
        ["open", "0", 1, "0", 0],
    ]


def test_an_unbounded_value_leaves_the_other_arrows_their_length() -> None:
    code = """
      const parts = [[1, Infinity, NaN, -4], [0, 0, 0, 3], [0, 0, 0, 0]].map((values) => ({ values }));
      return [arrows_js.findLargest({ parts }), arrows_js.findLargest({ parts: parts.slice(0, 1) })];
    """
    assert run(code, None) == [5, 4]  # of a vector, and of a drive, which has one component


@pytest.mark.parametrize(("a", "b"), [(-1, 0), (0, -1)])
def test_the_ground_may_be_either_end_of_a_support(a: int, b: int) -> None:
    joint = {"a": a, "b": b, "p": [0, 0, 5] if a < 0 else [0, 0, 0], "q": [0, 0, 5] if b < 0 else [0, 0, 0]}
    scene = SCENE | {"gravity": [0, -9.81, 0], "normal": [0, 0, 1], "joints": [joint]}
    assert run("return new view_js.View(given).side;", scene) == 1


def test_every_kind_of_joint_has_a_symbol() -> None:
    assert set(run("return symbols_js.DRAWN_KINDS;", None)) == set(TYPES)


def test_labels_avoid_arrows_while_there_is_room() -> None:
    code = """
      return given.map((arrows) => {
        const placed = [];
        const pen = { measureText: () => ({ width: 40 }), strokeText() {}, fillText: (_, x, y) => placed.push([x, y]) };
        const labels = new labels_js.LabelList();
        labels.begin(pen, 400, 300);
        for (const [from, to] of arrows) labels.avoid(from, to);
        labels.add("key", "words", 200, 150, "ink", 1);
        labels.write("paper");
        return placed;
      });
    """
    across = [[[0, y], [400, y]] for y in range(0, 300, 4)]  # no place is free of them
    free, beside, full = run(code, [[], [[[230, 0], [230, 200]]], across])
    assert free == full == [[208.0, 142.0]]  # to the upper right of its point
    ((x, _),) = beside
    assert x + 40 <= 200  # to the left of it
