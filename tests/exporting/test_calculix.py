"""CalculiX bears heun's load cases as heun's sections say: a bar of solids in any motion, held at six conditions alone.

The reactions of the holding tell of every sign, unit and mass; the stresses at a cut of the section loads there.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.study.queries.study import Study
from tests.shared.command import Heun
from tests.shared.scenes import near, study

CCX = shutil.which("ccx")
LENGTH, WIDTH, HEIGHT = 240.0, 12.0, 20.0  # [mm]
CELLS = (48, 2, 4)
MODULUS, POISSON, DENSITY = 210000.0, 0.3, 7.85e-9  # [MPa], [t/mm3]
LAYERS = (12, 24, 36)  # of bricks, whose stresses are looked at
CUTS = [(layer + 0.5) / CELLS[0] for layer in LAYERS]  # of the length, at their middles
STIFFNESS = 1e4  # [N/mm] of the springs that hold
# Two bars on balls, thrown about: the lower one bends in both planes, twists none, spins about all axes.
SCENE = f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  arm:
    shapes: [{{type: box, center: [0.05, 0, 0], size: [0.1, 0.02, 0.02], density: 7850}}]
    points: {{a: [0, 0, 0], b: [0.1, 0, 0]}}
    orientation: {{axis: [1, 2, 0.5], angle: 0.7}}
    angular_velocity: [20, -35, 50]
  bar:
    shapes: [{{type: box, center: [{LENGTH / 2000}, 0, 0],
               size: [{LENGTH / 1000}, {WIDTH / 1000}, {HEIGHT / 1000}], density: 7850}}]
    points: {{a: [0, 0, 0], b: [{LENGTH / 1000}, 0, 0]}}
    orientation: {{axis: [0.3, -1, 0.8], angle: 1.9}}
    angular_velocity: [-15, 60, 25]
joints:
  top: {{type: ball, from: ground.O, to: arm.a}}
  middle: {{type: ball, from: arm.b, to: bar.a}}
forces:
  push: {{type: force, on: bar.b, vector: [40, -30, 60]}}
sections:
  {
    " ".join(
        f'''
  cut{i}: {{body: bar, at: [{share * LENGTH / 1000}, 0, 0], normal: [1, 0, 0], first_axis: [0, 1, 0]}}'''
        for i, share in enumerate(CUTS)
    )
}
"""


class BarMesh(NamedTuple):
    """Nodes (nx, ny, nz, 3) of a bar of bricks, and the numbers of its nodes in the same grid."""

    places: Array
    numbers: Array

    @property
    def elements(self) -> list[list[int]]:
        """The nodes of each brick, as C3D8 has them."""
        n, (nx, ny, nz) = self.numbers, self.numbers.shape
        corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
        cells = [(i, j, k) for i in range(nx - 1) for j in range(ny - 1) for k in range(nz - 1)]
        return [[int(n[i + a, j + b, k + c]) for a, b, c in corners] for i, j, k in cells]


def bar_mesh() -> BarMesh:
    nx, ny, nz = CELLS
    axes = (np.linspace(0, LENGTH, nx + 1), np.linspace(-WIDTH / 2, WIDTH / 2, ny + 1))
    places = np.stack(np.meshgrid(*axes, np.linspace(-HEIGHT / 2, HEIGHT / 2, nz + 1), indexing="ij"), axis=-1)
    return BarMesh(places, 1 + np.arange(places[..., 0].size).reshape(places.shape[:3]))


def mesh_text(mesh: BarMesh) -> str:
    """The mesh with its material, and its end faces as surfaces for the two points."""
    places, numbers = mesh.places.reshape(-1, 3), mesh.numbers.ravel()
    lines = ["*NODE", *(f"{n}, {x}, {y}, {z}" for n, (x, y, z) in zip(numbers, places, strict=True))]
    elements = mesh.elements
    lines += ["*ELEMENT, TYPE=C3D8I, ELSET=BODY"]
    lines += [f"{i}, {', '.join(map(str, own))}" for i, own in enumerate(elements, start=1)]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{MODULUS}, {POISSON}", "*DENSITY", f"{DENSITY}"]
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL"]
    across = CELLS[1] * CELLS[2]
    for name, first, face in (("END_A", 1, "S6"), ("END_B", len(elements) - across + 1, "S4")):
        lines += [f"*SURFACE, NAME={name}", *(f"{first + i}, {face}" for i in range(across))]
    return "\n".join(lines) + "\n"


def coupled(nodes: tuple[int, int]) -> str:
    return "".join(
        f"*COUPLING, CONSTRAINT NAME=C{name}, REF NODE={node}, SURFACE=END_{name}\n*DISTRIBUTING\n1, 6\n"
        for node, name in zip(nodes, "AB", strict=True)
    )


def test_a_bar_in_motion(heun: Heun, folder: Path) -> None:
    """Reactions of the holding vanish beside the loads; stresses at three cuts make the section's N, M1, M2."""
    if CCX is None:
        pytest.skip("CalculiX is not installed: ccx is not on the path (Debian: calculix-ccx)")
    (folder / "bars.yaml").write_text(SCENE)
    run = study(SCENE)
    mesh = bar_mesh()
    (folder / "mesh.inp").write_text(mesh_text(mesh))
    words = "export loads bars.yaml --body bar --units N,mm,t --format calculix --first-node 5001 --mesh mesh.inp -o"
    done = heun(*words.split(), "loads.inp")
    assert done.returncode == 0 and "mass properties differ" not in done.stderr, done.stderr
    (folder / "all.inp").write_text(whole_deck(mesh, (folder / "loads.inp").read_text()))
    ran = subprocess.run([CCX, "-i", "all"], cwd=folder, capture_output=True, text=True, check=False)
    assert "Job finished" in ran.stdout, ran.stdout[-2000:]
    compare_with(run, mesh, (folder / "all.dat").read_text())


def whole_deck(mesh: BarMesh, loads: str) -> str:
    """Mesh, holding, heun's deck, and what is to be printed in its steps."""
    nodes, steps = re.split(r"(?=^\*\* -- case 1)", loads, maxsplit=1, flags=re.MULTILINE)
    printed = "*NODE PRINT, NSET=HELD\nU\n*EL PRINT, ELSET=LAYERS\nCOORD, S\n*END STEP"
    return mesh_text(mesh) + nodes + springs(mesh) + coupled((5001, 5002)) + steps.replace("*END STEP", printed)


def springs(mesh: BarMesh) -> str:
    """Six springs to the ground, which tell the reactions: what CalculiX prints as such has the node's loads in it."""
    lines = ["*NSET, NSET=HELD", *(f"{node}," for node, _ in held(mesh))]
    for i, (node, freedom) in enumerate((node, freedom) for node, own in held(mesh) for freedom in own):
        name, number = f"SPRING{i}", 100_001 + i
        lines += [f"*ELEMENT, TYPE=SPRING1, ELSET={name}", f"{number}, {node}"]
        lines += [f"*SPRING, ELSET={name}", f"{freedom}", f"{STIFFNESS}"]
    across = CELLS[1] * CELLS[2]
    lines += ["*ELSET, ELSET=LAYERS", *(f"{across * k + i + 1}," for k in LAYERS for i in range(across))]
    return "\n".join(lines) + "\n"


def held(mesh: BarMesh) -> list[tuple[int, tuple[int, ...]]]:
    """Six conditions at three corners, nodes with freedoms."""
    n = mesh.numbers
    return [(int(n[0, 0, 0]), (1, 2, 3)), (int(n[-1, 0, 0]), (2, 3)), (int(n[0, -1, 0]), (3,))]


def compare_with(run: Study, mesh: BarMesh, told: str) -> None:
    """Reactions against the loads, and the stresses of each layer against the section at its middle."""
    tables = [rows(block) for block in re.split(r"\n(?=\s[a-z]+ )", told) if rows(block)]
    displacements = {int(row[0]): row[1:] for row in tables[0]}
    reactions = [STIFFNESS * displacements[node][freedom - 1] for node, own in held(mesh) for freedom in own]
    sections = [run.results.sections[f"cut{i}"] for i in range(len(LAYERS))]
    force = max(float(np.abs(section["force"]).max()) for section in sections)
    near(reactions, 0.0, force, 1e-6)
    points, stresses = (np.array(table)[:, 2:] for table in tables[1:3])
    area, per_layer = WIDTH * HEIGHT, 8 * CELLS[1] * CELLS[2]
    for i, section in enumerate(sections):
        part = slice(per_layer * i, per_layer * (i + 1))
        y, z, s = points[part, 1], points[part, 2], stresses[part, 0]
        near(points[part, 0].mean(), CUTS[i] * LENGTH, LENGTH, 1e-6)
        found = {"N": area * s.mean(), "M1": area * (z * s).mean(), "M2": -area * (y * s).mean()}
        largest = 1e3 * max(float(np.abs(section[name]).max()) for name in ("M1", "M2"))
        near(found["N"], section["N"][0], force, 1e-3)
        for name in ("M1", "M2"):
            near(found[name], 1e3 * section[name][0], largest, 2e-3)


def rows(block: str) -> list[list[float]]:
    """The lines of numbers of a table."""
    return [[float(x) for x in line.split()] for line in block.splitlines() if re.match(r"\s+\d+\s", line)]
