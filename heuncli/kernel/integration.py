"""The interface to the stepping loop: one integration of a scene over requested instants, piece by piece.

The loop itself is in steps.py; this module holds its state, its memory and its output.
"""

from __future__ import annotations

from typing import Any

from heuncli.kernel.contact_rounding import clear_accelerations
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import HERMITE_ROWS, clip_time, evaluate_polynomial
from heuncli.kernel.events import hold_branches
from heuncli.kernel.following import is_linear, prepare_step
from heuncli.kernel.memory import Memory
from heuncli.kernel.response import evaluate
from heuncli.kernel.selection import choice_width
from heuncli.kernel.step_ends import restore_record
from heuncli.kernel.steps import run_steps
from heuncli.kernel.watches import MAX_PEAK_PARTS, reset_watches
from heuncli.kernel.workspace import Workspace


def record_width(workspace: Workspace, n: cython.int) -> int:
    """Return how many numbers a step of a state of n numbers starts from."""
    return 2 * n + choice_width(cython.address(workspace.scene))


def interpolate_steps(courses: dict[str, Any], n: cython.int, times: Any, states: Any, flags: Any) -> None:
    """Find states of n numbers at instants within steps whose polynomials were recorded, before their ends, (instants,
    n).

    courses: flat arrays `ends`, `spans` and `courses` of some steps, as an integration writes them. All arrays are
    flat; flags: 1 at these instants, 0 at the others, whose states stay as they are.
    """
    k: cython.Py_ssize_t
    memory: Memory = Memory()
    count: cython.Py_ssize_t = len(courses["ends"])
    rows: cython.Py_ssize_t = len(courses["courses"]) // max(n * count, 1)
    ends: cython.p_double = memory.view_row(courses["ends"])
    spans: cython.pp_double = memory.view_rows(courses["spans"], count, 3)
    course: cython.pp_double = memory.view_rows(courses["courses"], rows * count, n)
    t: cython.p_double = memory.view_row(times)
    rows_out: cython.pp_double = memory.view_rows(states, len(times), n)
    is_found: cython.p_double = memory.view_row(flags)
    for k in range(len(times)):
        step: cython.Py_ssize_t = find_step(ends, count, t[k])
        is_found[k] = 0.0
        if step < count and spans[step][HAS_COURSE] > 0.0 and t[k] < ends[step]:
            is_found[k] = 1.0
            x: cython.double = (t[k] - spans[step][STEP_START]) / spans[step][STEP_LENGTH]
            evaluate_polynomial(course, step * rows + 1, rows - 1, course[step * rows], n, x, rows_out[k])
    memory.fetch()


def find_step(ends: cython.p_double, count: cython.Py_ssize_t, t: cython.double) -> cython.Py_ssize_t:
    """Return the first step that does not end before t; `count` if there is none."""
    first: cython.Py_ssize_t = 0
    while first < count:
        middle: cython.Py_ssize_t = (first + count) // 2
        if ends[middle] < t:
            first = middle + 1
        else:
            count = middle
    return first


class Integration:
    """One integration of a scene over requested instants: the loop's state and its output."""

    def __init__(
        self, workspace: Workspace, method: dict[str, Any], start: dict[str, Any], output: dict[str, Any]
    ) -> None:
        """Prepare the integration of a workspace's scene; all arrays are flat.

        method: numbers and arrays by name (integration/methods)
        start: groups (a table), energy_group, weights, state, tolerance, step, rate, following, late
        output: times, samples, and of the steps ends, settled, pivots, turned, branches, passed, and, if polynomials
        are recorded, spans and courses; all are written to. With `following`, ends, settled and branches are given.
        """
        if not cython.compiled:
            self.run: Run = Run.blank()
            self.method: Method = Method.blank()
        self.workspace: Workspace = workspace
        self.output: dict[str, Any] = output
        self.memory: Memory = Memory()
        scene: cython.pointer[Scene] = cython.address(self.workspace.scene)
        self.set_method(method)
        self.set_start(start)
        if scene.watch_count or scene.held_count or scene.contact_count:
            self.allocate_course()
        if self.run.determined:
            self.allocate_branch()
        if method["implicit"]:
            self.allocate_newton(method["collocation"])
        self.set_output(output)

    def set_method(self, method: dict[str, Any]) -> None:
        """Copy the method's rows."""
        target: cython.pointer[Method] = cython.address(self.method)
        target.stages = method["stages"]
        target.extra = method["extra"]
        target.dense_rows = method["dense_rows"]
        target.estimates = method["estimates"]
        target.fixed = method["fixed"]
        target.by_step = method["by_step"]
        target.implicit = method["implicit"]
        target.attitude = method["attitude"]
        target.exponent = method["exponent"]
        self.run.determined = method["determined"]
        target.begin = self.memory.ints(method["begin"])
        target.stage = self.memory.ints(method["stage"])
        target.coefficient = self.memory.doubles(method["coefficient"])
        target.node = self.memory.doubles(method["node"])

    def set_start(self, start: dict[str, Any]) -> None:
        """Set the loop's state before the first piece, and allocate its memory; what is not set here begins at 0."""
        run: cython.pointer[Run] = cython.address(self.run)
        n: cython.int = len(start["weights"])
        run.n = n
        run.energy_group = start["energy_group"]
        run.control.tolerance = start["tolerance"]
        run.control.step = start["step"]
        run.control.rate = start["rate"]
        run.following = start["following"]
        run.late = start["late"]
        run.stiffness.short_limit = start["stiff_after"]
        run.stiffness.easy_limit = start["easy_after"]
        run.stiffness.total_limit = start["look_after"]
        run.stiffness.stable = start["stable"]
        run.weights = self.memory.doubles(start["weights"])
        run.y = self.memory.doubles(start["state"])
        run.z = self.memory.zeros(n)
        run.carry = self.memory.zeros(n)
        run.z_carry = self.memory.zeros(n)
        run.coarse = self.memory.zeros(n)
        run.fine = self.memory.zeros(n)
        run.stage = self.memory.zeros(n)
        run.K = self.memory.matrix(self.method.stages + 1 + self.method.extra, n)
        if self.method.by_step:
            run.side_stages = self.memory.matrix(self.method.stages, n)
        run.dense = self.memory.matrix(HERMITE_ROWS + self.method.dense_rows, n)
        self.allocate_chart(n)
        reset_watches(cython.address(self.workspace.scene))
        run.group_count = len(start["groups"])
        if cython.compiled:
            groups: cython.p_void = self.memory.copy_structs(start["groups"], cython.sizeof(Group))
            run.groups = cython.cast(cython.pointer[Group], groups)
        else:
            run.groups = [Group.from_numbers(row) for row in start["groups"].tolist()]

    def allocate_chart(self, n: cython.int) -> None:
        """Allocate the numbers that steps are taken in, if they are not the state's own."""
        run: cython.pointer[Run] = cython.address(self.run)
        run.chart.y, run.chart.z, run.chart.K = run.y, run.z, run.K
        if self.method.attitude:
            run.chart.angles_left = self.memory.zeros(self.workspace.scene.body_count)
            run.chart.y = self.memory.zeros(n)
            run.chart.z = self.memory.zeros(n)
            run.chart.K = self.memory.matrix(self.method.stages + 1 + self.method.extra, n)

    def allocate_course(self) -> None:
        """Allocate the course of the coordinates that expressions and contacts depend on, if something is watched."""
        scene: cython.pointer[Scene] = cython.address(self.workspace.scene)
        course: cython.pointer[Course] = cython.address(self.run.course)
        rows: cython.Py_ssize_t = 1 + HERMITE_ROWS + self.method.dense_rows
        course.value = self.memory.matrix(scene.variable_count, rows)
        course.rate = self.memory.matrix(scene.variable_count, rows)
        course.second = self.memory.matrix(scene.variable_count, rows)
        course.work = self.memory.zeros(rows)
        if scene.point_count:
            self.allocate_point_course(rows)
        course.begins = self.memory.zeros(MAX_PEAK_PARTS)
        course.ends = self.memory.zeros(MAX_PEAK_PARTS)  # more than halvings
        course.promise = self.memory.zeros(MAX_PEAK_PARTS)
        course.saved_branches = self.memory.zeros(scene.held_count)
        course.turned = self.memory.zeros(scene.held_count)
        course.resting = self.memory.zeros(scene.held_count)

    def allocate_point_course(self, rows: cython.Py_ssize_t) -> None:
        """Allocate the courses of the points that expressions use; rows: of a component of the state."""
        scene: cython.pointer[Scene] = cython.address(self.workspace.scene)
        points: cython.pointer[PointCourse] = cython.address(self.run.course.points)
        variables: cython.Py_ssize_t = scene.variable_count
        bodies: cython.Py_ssize_t = scene.body_count
        points.n = self.run.n
        points.chart = self.method.attitude
        points.origin = self.run.y
        points.states = self.memory.matrix(points.n, rows)
        points.slopes = self.memory.zeros(rows)
        points.state = self.memory.zeros(points.n)
        points.saved_variables = self.memory.zeros(variables)
        points.first_place = self.memory.zeros(variables)
        points.first_rate = self.memory.zeros(variables)
        points.last_place = self.memory.zeros(variables)
        points.last_rate = self.memory.zeros(variables)
        points.angular_velocity = self.memory.zeros(bodies)
        points.angular_acceleration = self.memory.zeros(bodies)
        points.acceleration = self.memory.zeros(bodies)
        points.reach = self.memory.zeros(bodies)
        points.speed = self.memory.zeros(bodies)

    def allocate_branch(self) -> None:
        """Allocate the data of a branch, and find the drives of its loops and the length that shifts are measured by.

        Rotations count in an island by its length (measure: 1 / length); the smallest of all islands is used.
        """
        i: cython.Py_ssize_t
        k: cython.Py_ssize_t
        n: cython.Py_ssize_t
        largest_measure: cython.double = 0.0
        scene: cython.pointer[Scene] = cython.address(self.workspace.scene)
        branch: cython.pointer[FollowedStep] = cython.address(self.run.followed_step)
        branch.travel = self.memory.doubles([-1.0] * (scene.freedom_count + scene.closure_count))
        branch.reach = self.memory.zeros(scene.freedom_count + scene.closure_count)
        branch.bends = self.memory.ints(bytes(4 * (scene.freedom_count + scene.body_count)))
        branch.marks = self.memory.zeros(3 * scene.counter_count)
        for i in range(scene.body_count):
            body: cython.pointer[Body] = cython.address(scene.bodies[i])
            if body.ball and scene.velocity_scale[body.velocity_at] > largest_measure:
                largest_measure = scene.velocity_scale[body.velocity_at]
            for k in range(body.first_freedom, body.end_freedom):
                freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
                if freedom.kind != SHIFT and scene.velocity_scale[freedom.velocity_at] > largest_measure:
                    largest_measure = scene.velocity_scale[freedom.velocity_at]
        branch.length = 1.0 / largest_measure if largest_measure > 0.0 else scene.size
        for i in range(scene.closure_count):
            if scene.closures[i].program.count:
                branch.travel[scene.freedom_count + i] = 0.0
            bends: cython.bint = not is_linear(scene, cython.address(scene.closures[i]))
            for n in range(scene.closures[i].path, scene.closures[i].path + scene.closures[i].path_count):
                path_body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
                if bends:
                    branch.bends[scene.freedom_count + scene.indices[n]] = 1
                for k in range(path_body.first_freedom, path_body.end_freedom):
                    if scene.freedoms[k].driven:
                        branch.travel[k] = 0.0
                    if bends:
                        branch.bends[k] = 1

    def allocate_newton(self, method: dict[str, Any]) -> None:
        """Copy the numbers of an implicit method, and allocate the iteration for its stages."""
        k: cython.Py_ssize_t
        n: cython.Py_ssize_t = self.run.n
        formula: cython.pointer[Collocation] = cython.address(self.method.collocation)
        newton: cython.pointer[Newton] = cython.address(self.run.newton)
        formula.stages = len(method["end"])
        formula.pair_count = len(method["parts"]) // 2
        formula.real = method["real"]
        formula.parts = self.memory.doubles(method["parts"])
        formula.T_inverse = self.memory.doubles(method["into"])
        formula.T = self.memory.doubles(method["back"])
        formula.end = self.memory.doubles(method["end"])
        formula.error = self.memory.doubles(method["error"])
        newton.tangent.n = n
        newton.tangent.J = self.memory.zeros(n * n)
        newton.tangent.derivative = self.memory.zeros(n)
        newton.tangent.change = self.memory.zeros(n)
        newton.real.A = self.memory.zeros(n * n)
        newton.real.pivots = self.memory.ints(bytes(4 * n))
        for k in range(formula.pair_count):
            newton.pairs[k].A = self.memory.zeros(n * n)
            newton.pairs[k].B = self.memory.zeros(n * n)
            newton.pairs[k].pivots = self.memory.ints(bytes(4 * n))
        newton.Z = self.memory.matrix(formula.stages, n)
        newton.polynomial_rows = self.memory.matrix(formula.stages + 1 + HERMITE_ROWS, n)
        for k in range(formula.stages):
            newton.polynomial_rows[k + 1] = newton.Z[k]
        for k in range(HERMITE_ROWS):
            newton.polynomial_rows[formula.stages + 1 + k] = self.run.dense[k]
        newton.W = self.memory.matrix(formula.stages, n)
        newton.step = self.memory.matrix(formula.stages, n)
        newton.error = self.memory.zeros(n)

    def set_output(self, output: dict[str, Any]) -> None:
        """Set the requested instants, and where states at them and at the ends of the steps are written."""
        run: cython.pointer[Run] = cython.address(self.run)
        run.samples.count = len(output["times"])
        run.track.capacity = len(output["ends"])
        run.samples.times = self.memory.doubles(output["times"])
        run.samples.states = self.memory.view_rows(output["samples"], run.samples.count, run.n)
        run.track.ends = self.memory.view_row(output["ends"])
        run.track.settled = self.memory.view_row(output["settled"])
        run.track.pivots = self.memory.view_row(output["pivots"])
        run.track.turned = self.memory.view_row(output["turned"])
        held_count: cython.int = self.workspace.scene.held_count
        run.track.branches = self.memory.view_rows(
            output["branches"], run.track.capacity if held_count else 0, held_count
        )
        run.track.passed = self.memory.view_rows(
            output["passed"], 0 if run.following else run.track.capacity, self.record_width
        )
        run.track.has_courses = len(output["spans"]) > 0
        rows: cython.Py_ssize_t = self.course_rows
        run.track.spans = self.memory.view_rows(output["spans"], run.track.capacity if run.track.has_courses else 0, 3)
        run.track.courses = self.memory.view_rows(
            output["courses"], rows * run.track.capacity if run.track.has_courses else 0, run.n
        )

    def begin(self, t: cython.double, before_end: cython.double, end: cython.double) -> None:
        """Begin a piece from t to its end, of which `before_end` is the last instant."""
        self.run.t, self.run.before_end, self.run.end, self.run.begins_piece = t, before_end, end, 1

    def jump(self, state: Any) -> None:
        """Continue from another state than the one reached; it replaces the sample at the instant reached too."""
        i: cython.Py_ssize_t
        run: cython.pointer[Run] = cython.address(self.run)
        k: cython.Py_ssize_t = run.samples.next - 1
        for i in range(run.n):
            run.y[i] = state[i]
            run.carry[i] = 0.0
        while k >= 0 and run.samples.times[k] == run.t:
            for i in range(run.n):
                run.samples.states[k][i] = run.y[i]
            k -= 1

    def restore(self, record: Any) -> None:
        """Restore the state from a record of `passed`; `begin` starts a piece from it, `resume` a step."""
        restore_record(cython.address(self.workspace.scene), cython.address(self.run), self.memory.doubles(record))

    def resume(self, t: cython.double, before_end: cython.double, end: cython.double) -> None:
        """Continue at t within a piece, bit by bit as the run whose record was restored."""
        scene: cython.pointer[Scene] = cython.address(self.workspace.scene)
        run: cython.pointer[Run] = cython.address(self.run)
        run.t, run.before_end, run.end, run.begins_piece = t, before_end, end, 0
        if scene.held_count:
            hold_branches(scene, run.track.branches[0])
        scene.programs.holding = HELD
        evaluate(scene, clip_time(run, t), run.y, run.K[0])
        clear_accelerations(scene, cython.address(self.method), run.K[0], True)
        if run.determined:
            prepare_step(scene, run)

    def set_followed_steps(self, ends: Any, projected_flags: Any, branches: Any) -> None:
        """Set the ends of the steps to be repeated, which of them projected their stages, and their branches, (n,
        held).
        """
        i: cython.Py_ssize_t
        k: cython.Py_ssize_t
        for i in range(len(ends)):
            self.run.track.ends[i] = float(ends[i])
            self.run.track.settled[i] = float(projected_flags[i])
            for k in range(self.workspace.scene.held_count):
                self.run.track.branches[i][k] = float(branches[i][k])

    def advance(self, max_steps: cython.int, watching: cython.bint, halting: cython.bint) -> int:
        """Take up to `max_steps` steps. Returns REACHED, MORE to do, or why it stopped.

        watching: stop where a contact closes or opens
        halting: stop where a piece begins, and where branches change
        """
        code: cython.int
        scene: cython.pointer[Scene] = cython.address(self.workspace.scene)
        run: cython.pointer[Run] = cython.address(self.run)
        method: cython.pointer[Method] = cython.address(self.method)
        run.track.capacity = max_steps
        run.watches_contacts = watching
        run.stops_at_turns = halting
        scene.programs.holding = HELD
        with cython.nogil:
            code = run_steps(scene, method, run)
        scene.programs.holding = FREE
        if not cython.compiled and not run.following:
            for name in ("ends", "settled", "pivots", "turned"):
                self.output[name][: run.track.step_count] = getattr(run.track, name)[: run.track.step_count]
            width = self.record_width
            for k in range(run.track.step_count):
                self.output["passed"][k * width : (k + 1) * width] = run.track.passed[k]
            held_count = self.workspace.scene.held_count
            for k in range(run.track.step_count if held_count else 0):
                self.output["branches"][k * held_count : (k + 1) * held_count] = run.track.branches[k]
        if not cython.compiled and run.track.has_courses:
            for k in range(run.track.step_count):
                self.output["spans"][3 * k : 3 * k + 3] = run.track.spans[k]
            for k in range(self.course_rows * run.track.step_count):
                self.output["courses"][k * run.n : (k + 1) * run.n] = run.track.courses[k]
        return code

    def stop_recording(self) -> None:
        """Record no more polynomials."""
        self.run.track.has_courses = 0

    def fetch(self) -> None:
        """Copy the samples into `output` (compiled, they are written there directly)."""
        if not cython.compiled:
            n = self.run.n
            for k in range(self.run.samples.count):
                self.output["samples"][k * n : (k + 1) * n] = self.run.samples.states[k]

    def state(self) -> list[float]:
        """Return the state reached."""
        return [self.run.y[i] for i in range(self.run.n)]

    @property
    def record_width(self) -> int:
        """Return how many numbers a record has."""
        return record_width(self.workspace, self.run.n)

    @property
    def course_rows(self) -> int:
        """Return the rows recorded of a step's polynomial: the state at its start, and the coefficients."""
        return 1 + HERMITE_ROWS + self.method.dense_rows

    @property
    def t(self) -> float:
        """Return the instant reached."""
        return self.run.t

    @property
    def last_step_count(self) -> int:
        """Return the number of steps of the last call."""
        return self.run.track.step_count

    @property
    def steps(self) -> int:
        """Return the number of accepted steps."""
        return self.run.steps

    @property
    def evaluations(self) -> int:
        """Return the number of evaluations of the derivative."""
        return self.run.evaluations

    @property
    def gap(self) -> float:
        """Return the largest gap that closures were left with [m]."""
        return self.run.gap

    @property
    def contact(self) -> int:
        """Return the closure row of the contact that closed or opened last; -1 if there was none."""
        return self.run.contact - 1

    @property
    def changed_branch(self) -> int:
        """Return the branch that changed last."""
        return self.run.course.slot

    @property
    def half_turn(self) -> int:
        """Return the body, by its index in the tree, that came to a half turn of the global chart."""
        return self.run.chart.half_turn - 1

    @property
    def undecided_count(self) -> int:
        """Return the number of steps for which bounds could not decide what happens in them."""
        return self.run.undecided

    @property
    def sampled_count(self) -> int:
        """Return how many of the requested instants are done."""
        return self.run.samples.next
