"""Products with the vectors and matrices of bodies at many instants, by component: (n, 3, n_t) and (n, 3, 3, n_t).

scene/shapes/rotations.py calls them; each sum has the order that is written there. All arrays are flat; an operand that
holds one instant holds at all of them. And the differences between the runs of a motion, from the tables of its bodies.
"""

from __future__ import annotations

from math import fabs, sqrt
from typing import Any

from heuncli.kernel.declarations import *
from heuncli.kernel.memory import Memory

POSITION = 9  # of a body's numbers (solutions.py): those of its attitude come first


def rotate_bodies(
    matrices: Any, vectors: Any, body_count: cython.Py_ssize_t, is_inverse: cython.bint, result: Any
) -> None:
    """Write R v, or R^T v, of each body."""
    memory: Memory = Memory()
    count: cython.Py_ssize_t = len(result) // (3 * body_count)
    rotate_rows(
        memory.view_row(matrices), 1 if len(matrices) == 3 * len(result) else 0,
        memory.view_row(vectors), 1 if len(vectors) == len(result) else 0,
        body_count, count, is_inverse, memory.view_row(result),
    )  # fmt: skip
    memory.fetch()


def rotate_rows(
    R: cython.p_double, R_step: cython.Py_ssize_t, v: cython.p_double, v_step: cython.Py_ssize_t,
    body_count: cython.Py_ssize_t, count: cython.Py_ssize_t, is_inverse: cython.bint, result: cython.p_double,
) -> cython.void:  # fmt: skip
    """Write the same; R_step, v_step: 1, or 0 where one instant holds at all of them."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    R_length: cython.Py_ssize_t = count if R_step else 1
    v_length: cython.Py_ssize_t = count if v_step else 1
    next_element: cython.Py_ssize_t = 3 * R_length if is_inverse else R_length
    for i in range(3 * body_count):
        row: cython.Py_ssize_t = (9 * (i // 3) + (i % 3 if is_inverse else 3 * (i % 3))) * R_length
        first: cython.Py_ssize_t = 3 * (i // 3) * v_length
        for k in range(count):
            x: cython.double = R[row + R_step * k] * v[first + v_step * k]
            y: cython.double = R[row + next_element + R_step * k] * v[first + v_length + v_step * k]
            z: cython.double = R[row + 2 * next_element + R_step * k] * v[first + 2 * v_length + v_step * k]
            result[i * count + k] = (x + y) + z if is_inverse else (x + z) + y


def cross_bodies(first: Any, second: Any, body_count: cython.Py_ssize_t, result: Any) -> None:
    """Write a x b of each body."""
    memory: Memory = Memory()
    cross_components_of(
        memory.view_row(first), memory.view_row(second), body_count, len(result) // (3 * body_count),
        memory.view_row(result),
    )  # fmt: skip
    memory.fetch()


def cross_components_of(
    a: cython.p_double, b: cython.p_double, body_count: cython.Py_ssize_t, count: cython.Py_ssize_t,
    result: cython.p_double,
) -> cython.void:  # fmt: skip
    """Write the same."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(3 * body_count):
        following: cython.Py_ssize_t = (3 * (i // 3) + (i + 1) % 3) * count
        last: cython.Py_ssize_t = (3 * (i // 3) + (i + 2) % 3) * count
        for k in range(count):
            result[i * count + k] = a[following + k] * b[last + k] - a[last + k] * b[following + k]


def square_bodies(vectors: Any, matrices: Any, body_count: cython.Py_ssize_t, result: Any) -> None:
    """Write v . J v of each body; matrices (n, 3, 3): of no instant."""
    i: cython.Py_ssize_t
    memory: Memory = Memory()
    count: cython.Py_ssize_t = len(result) // body_count
    v: cython.p_double = memory.view_row(vectors)
    J: cython.p_double = memory.view_row(matrices)
    squares: cython.p_double = memory.view_row(result)
    for i in range(body_count):
        square_rows(v, J, i, count, squares)
    memory.fetch()


def square_rows(
    v: cython.p_double, J: cython.p_double, body: cython.Py_ssize_t, count: cython.Py_ssize_t, squares: cython.p_double
) -> cython.void:
    """Write the same of one body."""
    k: cython.Py_ssize_t
    first: cython.Py_ssize_t = 3 * body * count
    m: cython.Py_ssize_t = 9 * body
    for k in range(count):
        x: cython.double = v[first + k]
        y: cython.double = v[first + count + k]
        z: cython.double = v[first + 2 * count + k]
        total: cython.double = x * J[m] * x + x * J[m + 1] * y + x * J[m + 2] * z
        total = total + y * J[m + 3] * x + y * J[m + 4] * y + y * J[m + 5] * z
        squares[body * count + k] = total + z * J[m + 6] * x + z * J[m + 7] * y + z * J[m + 8] * z


def bound_differences(
    bodies: Any, run_count: cython.Py_ssize_t, reach: Any, turn_rounding: cython.double, distance: Any, extent: Any
) -> None:
    """Write at each instant a bound of the distance between the points of any two runs, and the first run's largest
    coordinate.

    bodies: all numbers of the bodies (solutions.py), at each instant one run after the other; reach: of each body the
    distance of its farthest point; turn_rounding: added to each difference of attitudes
    """
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    other: cython.Py_ssize_t
    memory: Memory = Memory()
    body_count: cython.Py_ssize_t = len(reach)
    count: cython.Py_ssize_t = len(distance)
    state_width: cython.Py_ssize_t = len(bodies) // (run_count * count)
    numbers: cython.p_double = memory.view_row(bodies)
    reaches: cython.p_double = memory.doubles(reach.tolist())
    distances: cython.p_double = memory.view_row(distance)
    extents: cython.p_double = memory.view_row(extent)
    for j in range(count):
        first: cython.Py_ssize_t = j * run_count * state_width
        extents[j] = find_largest_coordinate(numbers, first, body_count, state_width // body_count)
        distances[j] = 0.0
        for k in range(run_count - 1):
            for other in range(k + 1, run_count):
                bound: cython.double = bound_difference(
                    numbers, first + k * state_width, first + other * state_width,
                    body_count, state_width // body_count, reaches, turn_rounding,
                )  # fmt: skip
                if bound > distances[j] or bound != bound:
                    distances[j] = bound
    memory.fetch()


def find_largest_coordinate(
    numbers: cython.p_double, first: cython.Py_ssize_t, body_count: cython.Py_ssize_t, width: cython.Py_ssize_t
) -> cython.double:
    """Return the largest coordinate of the bodies of one state; width: numbers of a body."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    largest: cython.double = 0.0
    for i in range(body_count):
        begin: cython.Py_ssize_t = first + i * width + POSITION
        for k in range(begin, begin + 3):
            size: cython.double = fabs(numbers[k])
            if size > largest or size != size:
                largest = size
    return largest


def bound_difference(
    numbers: cython.p_double, first: cython.Py_ssize_t, second: cython.Py_ssize_t,
    body_count: cython.Py_ssize_t, width: cython.Py_ssize_t, reach: cython.p_double, turn_rounding: cython.double,
) -> cython.double:  # fmt: skip
    """Return the bound of the distance between the points of two states; first, second: where their numbers begin."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    largest: cython.double = 0.0
    for i in range(body_count):
        a: cython.Py_ssize_t = first + i * width
        b: cython.Py_ssize_t = second + i * width
        turned: cython.double = 0.0
        for k in range(POSITION):
            turned += (numbers[b + k] - numbers[a + k]) * (numbers[b + k] - numbers[a + k])
        shifted: cython.double = 0.0
        for k in range(POSITION, POSITION + 3):
            shifted += (numbers[b + k] - numbers[a + k]) * (numbers[b + k] - numbers[a + k])
        bound: cython.double = sqrt(shifted) + (sqrt(0.5 * turned) + turn_rounding) * reach[i]
        if bound > largest or bound != bound:
            largest = bound
    return largest
