"""Small oscillations, the motions exp(l t) of the reduced linear equations, and the modes of a scene as reported.

    l = growth + 2 pi i frequency;   damping ratio = -growth / |l|

What nothing holds is found from the null space of the stiffness and removed before the rest is solved: rounding splits
the double eigenvalue 0 of a free motion into two of the order of its root, which would look like a frequency. Without
damping and gyroscopic terms, l^2 are the eigenvalues of -K, half as many, and real for loads with a potential. The
error of an eigenvalue is rounding times its own condition; a growth below that counts as none.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import is_length
from heuncli.base.linear_algebra import split_null_space
from heuncli.base.records import record
from heuncli.motion.linearisation.indifference import IndifferentMotions
from heuncli.motion.linearisation.reduced_equations import ReducedEquations
from heuncli.results.results import Array

# Oscillations

Kind = Literal["free", "decay", "divergence", "oscillation", "flutter"]


@record
class Mode:
    """One motion: its eigenvalue l [1/s] with its error, and its shape (n,) on the freedoms of the tree, complex.

    A pair of conjugate eigenvalues is one motion, with the positive frequency. A free motion has the eigenvalue 0, and
    its error bounds the frequency and growth of motions that cannot be distinguished from a free one.
    """

    kind: Kind
    eigenvalue: complex
    error: float
    shape: Array

    @property
    def frequency(self) -> float:
        """Frequency [Hz]."""
        return self.eigenvalue.imag / (2.0 * np.pi)

    @property
    def growth(self) -> float:
        """Growth rate [1/s]."""
        return self.eigenvalue.real

    @property
    def damping(self) -> float:
        """Lehr's damping ratio: 1 for decay without oscillation, -1 for divergence, 0 for free motions."""
        return 0.0 - self.eigenvalue.real / abs(self.eigenvalue) if self.eigenvalue else 0.0


def find_modes(system: ReducedEquations, indifferent: IndifferentMotions) -> list[Mode]:
    """Find all motions: free ones, then those that creep or diverge, and oscillations by frequency."""
    if system.count == 0:
        return []
    if not system.A11.any() and not system.A22.any():
        rows = solve_undamped(system, indifferent)
    else:
        rows = solve_damped(system, indifferent)
    modes = [make_mode(system, value, float(error), x, free) for value, error, x, free in rows]
    return sorted(modes, key=lambda mode: (mode.kind != "free", mode.frequency, abs(mode.growth)))


def make_mode(system: ReducedEquations, eigenvalue: complex, error: float, x: Array, free: bool) -> Mode:
    """Make a mode from its eigenvalue and its displacement x in the reduced coordinates."""
    return classify_mode(system.tangent @ x, system.mass, eigenvalue, error, free)


def classify_mode(shape: Array, mass: Array, eigenvalue: complex, error: float, free: bool) -> Mode:
    """Make a mode from its eigenvalue and its displacement (n,) of the tree's freedoms; mass: their mass matrix."""
    if free:
        return Mode("free", 0j, error, shape)
    error += 0.5 * abs(eigenvalue) * tolerances.EIGENVALUE * measure_cancellation(mass, shape)
    growth = eigenvalue.real if abs(eigenvalue.real) > error else 0.0
    if eigenvalue.imag == 0.0:
        return Mode("divergence" if growth > 0.0 else "decay", complex(growth), error, shape)
    return Mode("flutter" if growth > 0.0 else "oscillation", complex(growth, eigenvalue.imag), error, shape)


def measure_cancellation(M: Array, v: Array) -> float:
    """Return the ratio of the terms of v* M v to their sum: large where a light body moves on heavy ones."""
    size = np.abs(v)
    return float(size @ np.abs(M) @ size / abs(v.conj() @ M @ v))


EigenRow = tuple[complex, float, Array, bool]


def solve_undamped(system: ReducedEquations, indifferent: IndifferentMotions) -> list[EigenRow]:
    """Solve x'' + K x = 0: l^2 = -k of the eigenvalues k of K."""
    K = -system.A21
    rounding = tolerances.EIGENVALUE * len(K) * max(find_spectral_norm(K), system.stiffness_scale)
    null_shapes = find_nilpotent_shapes(indifferent)
    rows: list[EigenRow] = [(0j, float(np.sqrt(indifferent.error)), x, True) for x in null_shapes.T]
    null_basis, rest = complete_basis(null_shapes)
    if not rest.shape[1]:
        return rows
    B = rest.T @ K @ rest
    if np.abs(B - B.T).max() <= rounding:
        values, vectors = symmetric_eigenvalues(B, indifferent, rest)
        errors = np.minimum(rounding, indifferent.estimate_stiffness_error(rest @ vectors))
    else:
        values, vectors, condition = find_eigenvalues_with_condition(B)
        errors = condition * rounding
    for k, error, v in zip(
        values, errors, complete_eigenvectors(K, null_basis, rest, values, vectors, errors).T, strict=True
    ):
        rows += make_roots(complex(k), float(error), v)
    return rows


def find_stiffnesses(system: ReducedEquations, indifferent: IndifferentMotions) -> tuple[Array, Array]:
    """Return the eigenvalues of K per unit mass of all that is held or pushed off, real parts (m,), and shapes x (f,
    m).
    """
    K = system.stiffness
    _, rest = complete_basis(find_nilpotent_shapes(indifferent))
    if not rest.shape[1]:
        return np.zeros(0), rest
    B = rest.T @ K @ rest
    rounding = tolerances.EIGENVALUE * len(K) * max(find_spectral_norm(K), system.stiffness_scale)
    values, vectors = (
        symmetric_eigenvalues(B, indifferent, rest) if np.abs(B - B.T).max() <= rounding else np.linalg.eig(B)
    )
    return values.real, rest @ vectors


def symmetric_eigenvalues(B: Array, indifferent: IndifferentMotions, rest: Array) -> tuple[Array, Array]:
    """Return eigenvalues and vectors of a symmetric B = rest' K rest, small ones to their own digits next to large
    ones.

        k = v' K v - sum (v' K w)^2 / (l - k)    over the other vectors w: removes their rounding, to second order
    """
    _, V = np.linalg.eigh(0.5 * (B + B.T))
    stiffness = indifferent.find_mutual_stiffness(rest @ V)
    values = np.diag(stiffness).copy()
    differences = values[None, :] - values[:, None]
    coupled = 0.5 * (stiffness + stiffness.T) - np.diag(values)
    is_separate = np.abs(differences) > np.abs(coupled)
    return values - np.where(is_separate, coupled**2 / np.where(is_separate, differences, 1.0), 0.0).sum(axis=1), V


def find_nilpotent_shapes(indifferent: IndifferentMotions) -> Array:
    """Return what K maps to zero, and what it maps to that, (f, m): the other halves of a double eigenvalue 0."""
    shapes = [indifferent.right_null]
    while (
        next_shapes := shapes[-1]
        @ split_null_space(indifferent.left_null.T @ shapes[-1], tolerances.NEARLY_DEFECTIVE)[0]
    ).shape[1]:
        shapes.append(normalise(indifferent.compliance @ next_shapes))
    return np.concatenate(shapes, axis=1)


def make_roots(k: complex, error: float, x: Array) -> list[EigenRow]:
    """Return the motions l = +-sqrt(-k): one oscillates, or two diverge and decay, or flutter and its counterpart."""
    root = complex(np.sqrt(-k + 0j))
    root_error = error / (2.0 * abs(root))
    if abs(k.imag) <= error:
        if k.real > 0.0:
            return [(1j * abs(root), root_error, x, False)]
        return [(complex(abs(root)), root_error, x, False), (complex(-abs(root)), root_error, x, False)]
    if k.imag < 0.0:
        return []  # the conjugate gives the same motion
    root = root if root.imag > 0.0 else -root
    # l and -l*, the other of the four with a positive frequency: that of the conjugate shape
    return [(root, root_error, x, False), (-root.conjugate(), root_error, x.conj(), False)]


def solve_damped(system: ReducedEquations, indifferent: IndifferentMotions) -> list[EigenRow]:
    """Solve (x, z)' = A (x, z), with rates in units of the fastest motion and free motions removed first."""
    f, K = system.count, system.stiffness
    scale = max(
        float(np.sqrt(max(find_spectral_norm(K), system.stiffness_scale))),
        find_spectral_norm(system.A22),
        find_spectral_norm(system.A11),
    )
    A = np.block([[system.A11, scale * np.eye(f)], [system.A21 / scale, system.A22]])
    rounding = tolerances.EIGENVALUE * len(A) * scale
    rows: list[EigenRow] = [(0j, float(np.sqrt(indifferent.error)), x, True) for x in indifferent.right_null.T]
    null_basis, rest = complete_basis(find_generalised_null_space(system, indifferent, scale))
    if not rest.shape[1]:
        return rows
    values, vectors, condition = find_eigenvalues_with_condition(rest.T @ A @ rest)
    errors = condition * rounding
    shapes = complete_eigenvectors(A, null_basis, rest, values, vectors, errors)[:f]
    for value, error, x in zip(values, errors.tolist(), shapes.T, strict=True):
        if abs(value.imag) <= error:  # a double root, at the aperiodic limit, is split by rounding
            rows.append((complex(value.real), error, x, False))
        elif value.imag > 0.0:
            rows.append((complex(value), error, x, False))
    return rows


def find_generalised_null_space(system: ReducedEquations, indifferent: IndifferentMotions, scale: float) -> Array:
    """Return all (x, z / scale) that powers of A map to zero, (2 f, m), starting with what stays, x' = z' = 0.

    A w_k = w_(k-1):   K x_k = A22 x_(k-1) - z_(k-1),  z_k = x_(k-1) - A11 x_k,  if the left null space of K permits
    """
    A11, A22 = system.A11, system.A22
    X, Z = indifferent.right_null, -A11 @ indifferent.right_null
    blocks = [np.concatenate([X, Z / scale])]
    # where gyroscopic terms cancel, A11 and A22 are the rounding of terms of the order of the spins
    small = (
        tolerances.EIGENVALUE
        * system.count
        * (find_spectral_norm(A11) + find_spectral_norm(A22) + float(np.sqrt(system.stiffness_scale)))
    )
    while X.shape[1]:
        forces = A22 @ X - Z
        combinations = split_null_space(indifferent.left_null.T @ forces, small)[0]
        responses = indifferent.compliance @ forces @ combinations
        X, Z = responses, X @ combinations - A11 @ responses
        blocks.append(np.concatenate([X, Z / scale]))
        small = tolerances.NEARLY_DEFECTIVE * find_spectral_norm(np.concatenate([X, Z, A22 @ X - Z]))
    return normalise(np.concatenate(blocks, axis=1))


def normalise(columns: Array) -> Array:
    """Normalise columns to length 1."""
    return np.asarray(columns / np.sqrt(np.sum(columns**2, axis=0)))


def complete_basis(columns: Array) -> tuple[Array, Array]:
    """Return orthonormal bases of the span of independent columns (in their order), and of its complement."""
    n, m = columns.shape
    Q = np.linalg.qr(columns, mode="complete")[0] if m else np.eye(n)
    return Q[:, :m], Q[:, m:]


def complete_eigenvectors(
    A: Array, null_basis: Array, rest: Array, values: Array, vectors: Array, errors: Array
) -> Array:
    """Return the eigenvectors of A from those of its quotient, adding their part in the removed subspace.

    (k - N) y = T' A v,  N = T' A T: A maps each column of T to those before it, so N is 0 on and below its diagonal.
    Where k may be 0, there is no such part: it cannot be distinguished from what was removed.
    """
    lifted = rest @ vectors
    if not null_basis.shape[1]:
        return lifted
    N, coupling = np.triu(null_basis.T @ A @ null_basis, 1), null_basis.T @ A @ rest
    identity = np.eye(len(N))
    parts = [
        np.linalg.solve(k * identity - N, coupling @ v) if abs(k) > error else np.zeros(len(N))
        for k, v, error in zip(values, vectors.T, errors, strict=True)
    ]
    return np.asarray(lifted + null_basis @ np.array(parts).T)


def find_eigenvalues_with_condition(A: Array) -> tuple[Array, Array, Array]:
    """Return eigenvalues, right vectors, and the condition of each: |x| |y| / |y x| of the right and the left
    vector.
    """
    values, vectors = np.linalg.eig(A)
    left_vectors = np.linalg.pinv(vectors)
    lengths = np.sqrt(np.sum(np.abs(left_vectors) ** 2, axis=1))
    return values, vectors, lengths * np.sqrt(np.sum(np.abs(vectors) ** 2, axis=0))


def find_spectral_norm(A: Array) -> float:
    """Return the largest singular value; 0 for an empty matrix."""
    return float(np.linalg.norm(A, 2)) if A.size else 0.0


# Modes


@record
class SceneModes:
    """The modes of a scene.

    reference: the pose they are about, "rest" or "state"
    shapes: coordinates of each mode, the largest 1
    """

    title: str
    reference: Literal["rest", "state"]
    is_steady: bool  # something moves steadily; the modes are seen from its frame
    has_held_drives: bool  # there are drives, and they are held
    modes: tuple[Mode, ...]
    shapes: tuple[dict[str, complex], ...]
    largest: tuple[tuple[str, ...], ...]  # the coordinates that move most in each mode, lengths relative to the size
    omitted_paths: tuple[str, ...] = ()  # forces left out and drives held, as `forces.push`
    sticking_paths: tuple[str, ...] = ()  # dry friction that sticks, as `forces.rub`

    def to_block(self) -> dict[str, Any]:
        """Return the modes as in the JSON output."""
        rows = [mode_to_block(mode, shape) for mode, shape in zip(self.modes, self.shapes, strict=True)]
        without = {"without": list(self.omitted_paths)} if self.omitted_paths else {}
        held = {"held": list(self.sticking_paths)} if self.sticking_paths else {}
        return {"at": self.reference, "steady": self.is_steady, **without, **held, "modes": rows}


def mode_to_block(mode: Mode, shape: dict[str, complex]) -> dict[str, Any]:
    """Return a mode as in the JSON output; error [1/s]: of growth and 2 pi frequency."""
    return {
        "frequency": mode.frequency,
        "damping": mode.damping,
        "growth": mode.growth,
        "kind": mode.kind,
        "error": mode.error,
        "shape": {name: [x.real + 0.0, x.imag + 0.0] for name, x in shape.items()},
    }


def make_shape(x: Array, rows: dict[str, Array]) -> dict[str, complex]:
    """Return a displacement by coordinates, its largest 1."""
    components = {name: complex(row @ x) for name, row in rows.items()}
    largest = max(components.values(), key=abs, default=0j)
    return {name: value / largest if largest else value for name, value in components.items()}


def find_largest_coordinates(shape: dict[str, complex], size: float) -> tuple[str, ...]:
    """Return the coordinates that move most, at most three that move by at least half of it; lengths relative to the
    size.
    """
    magnitudes = {name: abs(x) / (size if is_length(name) else 1.0) for name, x in shape.items()}
    largest = max(magnitudes.values(), default=0.0)
    names = sorted(
        (name for name, x in magnitudes.items() if x >= 0.5 * largest), key=lambda name: -round(magnitudes[name], 9)
    )
    return tuple(names[:3]) or ("nothing",)
