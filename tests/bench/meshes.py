"""What bodies from CAD take: a ring of 100,000 triangles read from each format and checked, and cut: processor time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from heuncli.scene.file_format.models import Shape
from heuncli.scene.meshes.reading import read_closed_mesh, read_soup
from heuncli.scene.shapes.composite_solid import make_composite_solid
from heuncli.scene.shapes.figures import CuttingPlanes, find_figure
from tests.bench.load_cases import least_ms
from tests.shared import triangles as t

AROUND = ((250, 200), (500, 100), (2500, 20))  # rings of so many by so many nets
PLANES = 50
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
WRITERS: dict[str, Callable[[Any], bytes]] = {
    "binary.stl": t.binary_stl, "text.stl": lambda x: t.text_stl(x).encode(), "a.obj": lambda x: t.obj(x).encode(),
    "text.ply": t.ply, "binary.ply": lambda x: t.ply(x, "<"),
}  # fmt: skip


def meshes() -> None:
    """Print them."""
    ring = t.torus(500, 100)
    for name, written in WRITERS.items():
        content = written(ring)
        read = least_ms(lambda content=content, name=name: read_soup(content, name))  # type: ignore[misc]
        whole = least_ms(lambda content=content, name=name: read_closed_mesh(content, name))  # type: ignore[misc]
        print(f"{name:12} {len(content) / 1e6:5.1f} MB  read {read:6.1f} ms, with all checks {whole:6.1f} ms")
    for n, m in AROUND:
        mesh = read_closed_mesh(t.binary_stl(t.torus(n, m)), "a.stl")
        f = make_composite_solid(
            [Shape("mesh", density=1.0, mesh=mesh, scale=1.0, at=(0.0, 0.0, 0.0), rotation=IDENTITY)]
        )
        for normal in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.48, 0.6, 0.64)):
            print(f"ring {n} x {m}, {PLANES} planes across {normal}: {_cuts(f, np.array(normal))}")


def _cuts(f: Any, normal: Any) -> str:
    """What cuts across a normal take."""
    d, side = np.linspace(*f.extent(normal), PLANES), np.ones(PLANES)
    e1 = np.array([0.0, 1.0, 0.0]) if normal[1] == 0.0 else np.array([0.8, 0.0, -0.6])
    pieces = least_ms(lambda: f.pieces(normal, d, side))
    sections = least_ms(lambda: f.cross_sections(normal, d, side))
    outlines = least_ms(lambda: find_figure(f.parts[0], CuttingPlanes(normal, e1, d, d)))
    return f"pieces {pieces:5.1f} ms, where they are cut {sections:5.1f} ms, properties of outlines {outlines:5.1f} ms"
