"""What the gallery draws: a row a picture, a page, a report, of specs beside the package and of those in scenes/."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from tests.shared.folders import ROOT

SCENES = Path(__file__).with_name("scenes")
ANGLE = "--x coordinates.main.angle --units deg,kN"
SWEEP = "sweep {spec} %s --measure 'max joints.main.force' -q --store {target}.sqlite"


class Picture(NamedTuple):
    """A picture of heun plot: its kind, spec, the words behind it; before: a command that writes its source."""

    kind: str
    spec: str
    words: str
    before: str = ""
    command: str = "plot"

    @property
    def name(self) -> str:
        """The name of its file."""
        what = "".join(letter if letter.isalnum() else "_" for letter in self.words.partition(" --units")[0])
        return f"{self.kind}-{self.spec}-{what.strip('_')}"[:70]


class Page(NamedTuple):
    """A moving page of heun show, in a window of a size [pixels]; frame: its number, in parts of all frames."""

    spec: str
    words: str = ""
    width: int = 1600
    height: int = 950
    dark: bool = False
    frame: float = 0.4

    @property
    def name(self) -> str:
        """The name of its file."""
        return f"page-{self.spec}-{self.width}{'-dark' * self.dark}"


class Report(NamedTuple):
    """A report of heun report, with its options."""

    spec: str
    words: str = "--units kN,mm"

    @property
    def name(self) -> str:
        """The name of its file."""
        return f"report-{self.spec}"


PICTURES = (
    Picture("scene", "suspension", "scene --units kN,mm"),
    Picture("scene", "suspension", "scene --view x --units kN,mm"),
    Picture("scene", "press", "scene --units kN,mm"),
    Picture("scene", "press", "scene rod.small --at 0.1,0.25"),
    Picture("scene", "gearbox", "scene --units N,mm"),
    Picture("scene", "gearbox", "scene --view z --units N,mm"),
    Picture("scene", "crane_ropes", "scene --units kN,m"),
    Picture("scene", "v_engine", "scene --units kN,mm"),
    Picture("scene", "v_engine", "scene --case full_load --view x --at 0.0012 --units kN,mm"),
    Picture("scene", "engine", "scene --units kN,mm"),
    Picture("scene", "excavator", "scene stick.bucket --at 0,4 --units kN,m"),
    Picture("scene", "engine_mounts", "scene --units N,mm"),
    Picture("scene", "planetary", "scene --units N,mm"),
    Picture("scene", "screw_press", "scene --units kN,mm"),
    Picture("history", "suspension", "forces.lower_front.force forces.spring.value --case all --units kN,mm"),
    Picture("history", "press", "joints.main.force coordinates.main.rate forces.tool.value --units kN,rpm"),
    Picture("history", "press", f"joints.main.force joints.big.force joints.guide.force {ANGLE}"),
    Picture("history", "gearbox", "joints.in_float.radial joints.out_float.radial couplings.second.force --units kN"),
    Picture("history", "crane_ropes", "couplings.hoist.tension couplings.pendant.tension --units kN"),
    Picture("history", "v_engine", f"joints.main.force joints.rear.force {ANGLE}"),
    Picture("history", "engine", "joints.main.force joints.wrist.force coordinates.main.rate --units kN,rpm"),
    Picture("history", "engine", "forces.gas.value --x coordinates.bore.travel --units kN,mm"),
    Picture("history", "axle_loads", "joints.front.force joints.rear.force --case all --units kN"),
    Picture("history", "engine_mounts", "forces.front_left.shift.z forces.front_left.force.z --units mm,N"),
    Picture("history", "bouncing_ball", "bodies.ball.center.z bodies.ball.velocity.z"),
    Picture("history", "four_bar", "bodies.coupler.center.y --x bodies.coupler.center.x --units mm"),
    Picture("sections", "press", "sections.rod --units kN,mm"),
    Picture("sections", "gearbox", "sections.output --units N,mm"),
    Picture("sections", "crane_ropes", "sections.jib --units kN,m"),
    Picture("sections", "v_engine", "sections.rod1 --units kN,mm"),
    Picture("sections", "overhang", "sections.beam"),
    Picture("sections", "gerber_beam", "sections.right --units kN,m"),
    Picture("sections", "crane_load", "sections.along --at 1,3.5 --tension-side --units kN,m"),
    Picture("sections", "chimney", "sections.shaft --units kN,m"),
    Picture("polar", "engine", "polar joints.main --axes to --units kN"),
    Picture("polar", "v_engine", "polar joints.main --case full_load --units kN"),
    Picture("polar", "rotor", "polar joints.right"),
    Picture("modes", "engine_mounts", "modes --without idle"),
    Picture("modes", "chain", "modes"),
    Picture("balance", "six_cylinder", "balance"),
    Picture("balance", "slider_crank", "--counterweight crank.main", command="balance"),
    Picture("sweep", "press", "", before=SWEEP % "r=70:90/5mm F=400:560/5kN"),
    Picture("sweep", "engine", "", before=SWEEP % "n=1000:3000/9rpm"),
    Picture("chart", "double", "--methods RK4,DOPRI5,DOP853,Gauss6,Radau5 --tolerances 1e-4,1e-7", command="chart"),
)  # fmt: skip

PAGES = (
    Page("suspension", "--units kN,mm,deg"),
    Page("suspension", "--units kN,mm,deg", 420, 900),
    Page("press", "--units kN,mm,deg"),
    Page("gearbox", "--units N,mm,deg"),
    Page("crane_ropes", "--units kN,m"),
    Page("crane_ropes", "--units kN,m", 420, 900),
    Page("v_engine", "--case all --units kN,mm,deg"),
    Page("v_engine", "--units kN,mm,deg", dark=True),
    Page("engine", "--units kN,mm,deg"),
    Page("excavator", "--units kN,m,deg", dark=True),
)

REPORTS = (
    Report("suspension"),
    Report("press"),
    Report("gearbox", "--units N,mm"),
    Report("crane_ropes", "--units kN,m"),
    Report("v_engine"),
    Report("axle_loads", "--units kN,mm"),
)


def find_spec(name: str) -> Path:
    """Find a spec by its name: one of the gallery's own, or one of those beside the package."""
    own = SCENES / f"{name}.yaml"
    return own if own.exists() else ROOT / "specs" / f"{name}.yaml"
