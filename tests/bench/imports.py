"""What `heun import` takes: of robots in URDF, and of processes beside that of a robot of one link."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from typing import Any

import numpy as np

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load
from tests.shared.imported import imported
from tests.shared.urdf_trees import random_robot, urdf_text

SIZES = (40, 1000, 10_000)
TOO_MANY = 1_000_000
TINY = '<robot name="r"><link name="a"/><link name="b">{}</link><joint name="j" type="fixed">{}</joint></robot>'
BODY = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
ENDS = '<parent link="a"/><child link="b"/>'


def imports(median_ms: Callable[[Callable[[], Any], int], float]) -> None:
    """Print them; median_ms: of a call that is repeated so often [ms]."""
    for size in SIZES:
        text = urdf_text(random_robot(np.random.default_rng(size), size))
        repeats = 9 if size < 1000 else 1
        read = median_ms(lambda text=text: imported(text), repeats)  # type: ignore[misc]
        spec = imported(text)
        judged = median_ms(lambda spec=spec: load("robot.yaml", spec), repeats)  # type: ignore[misc]
        print(f"import {size:6} links: read and said {read:7.1f} ms, the spec validated {judged:7.1f} ms")
    with tempfile.TemporaryDirectory() as folder:
        robot = urdf_text(random_robot(np.random.default_rng(40), 40))
        texts = {"40 links": robot, "a link": TINY.format(BODY, ENDS)}
        times: dict[str, list[float]] = {name: [] for name in texts}
        for name, text in texts.items():
            Path(folder, f"{name}.urdf").write_text(text)
        for _ in range(9):
            for name, found in times.items():
                found.append(_process(Path(folder, f"{name}.urdf")))
        both = " against ".join(f"{name} {1e3 * sorted(found)[4]:.0f} ms" for name, found in times.items())
    print(f"import, whole processes: {both}")
    begun = time.process_time()
    try:
        imported("<robot>" + "<link name='x'/>" * (TOO_MANY + 1) + "</robot>")
    except SpecError as error:
        print(
            f"import {TOO_MANY:,} links: refused ({error.problems[0].code}) after {time.process_time() - begun:.1f} s"
        )


def _process(file: Path) -> float:
    """Processor time of a whole process [s]."""
    before = getrusage(RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-m", "heuncli", "import", str(file)], stdout=subprocess.DEVNULL, check=True)
    after = getrusage(RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
