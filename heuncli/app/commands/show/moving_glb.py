"""The moving bodies of a solved scene as a file for programs that draw in space: up to its horizon, close enough."""

from __future__ import annotations

import math

from heuncli.base import tolerances
from heuncli.output.figures.courses import instants
from heuncli.output.machine_geometry.gltf import binary
from heuncli.output.machine_geometry.poses import poses_of, up_of
from heuncli.output.web_page.geometry import looks_of
from heuncli.study.ask.study import Study
from heuncli.study.search.instants import turned_between

TOLD = "--glb: between two of its instants a body turns up to {:.0f}°; what is shown between them is not the motion"


def moving_glb(study: Study) -> bytes:
    """The file of a study whose motion was solved; the study's warnings tell where its instants are too few."""
    times = instants(study)
    if not study.of_one_instant and len(times) > 1:
        turned = float(turned_between(study.setup, study.history, times).max(initial=0.0))
        if turned > tolerances.TORN:
            study.later_warnings[TOLD.format(math.degrees(turned))] = None
    poses = poses_of(study, times)
    return binary(looks_of(study.spec, study.setup.scene), poses, up_of(study.spec, poses))
