"""Radial basis functions over the parameter grid (section 5), solved once for all maps.

Coordinates are grid steps (:meth:`ParameterSpace.to_unit`): nodes lie at whole numbers, so
that axes of different units and spacings weigh the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError
from walklab.steering import kernels
from walklab.steering.multilinear import MultilinearInterpolant

Array = NDArray[np.float64]
Kernel = Literal["multiquadric", "thin_plate_spline", "cubic", "linear", "gaussian"]
Basis = Literal["rbf", "multilinear"]

# kernel -> (number in compiled code, degree of the polynomial that scipy adds by default)
KERNELS: dict[str, tuple[int, int]] = {
    "multiquadric": (kernels.MULTIQUADRIC, 0),
    "thin_plate_spline": (kernels.THIN_PLATE_SPLINE, 1),
    "cubic": (kernels.CUBIC, 1),
    "linear": (kernels.LINEAR, 0),
    "gaussian": (kernels.GAUSSIAN, 0),
}


@dataclass(frozen=True)
class GridInterpolant:
    """``f(x) = sum_i c_i phi(epsilon |x - x_i|) + polynomial``, exact at the C grid nodes.

    Equal to ``scipy.interpolate.RBFInterpolator`` with its default degree. ``f`` is linear in the
    map, so the coefficients of a blend of maps are the blend of their coefficients.

    Attributes
    ----------
    shape : number of values on each of the P axes
    kernel : ``phi``; multiquadric ``-sqrt(1 + r^2)``, thin_plate_spline ``r^2 log r``, cubic ``r^3``,
        linear ``-r``, gaussian ``exp(-r^2)``
    epsilon : inverse width of the kernel, 1/grid steps
    """

    shape: tuple[int, ...]
    kernel: Kernel = "multiquadric"
    epsilon: float = 1.0

    name = "rbf"

    def __post_init__(self) -> None:
        # ASSUME: The paper does not name its radial basis function; multiquadric with a width of one grid step is
        # taken, the default kernel and nearly the default width (0.9 steps on this grid) of scipy's Rbf of 2017, which it
        # cites; a constant is added, as scipy's RBFInterpolator of today does.
        if self.kernel not in KERNELS:
            raise InputError(f"kernel: there is no {self.kernel!r}; choose one of {', '.join(KERNELS)}")
        if not 0 < self.epsilon < np.inf:
            raise InputError(f"kernel epsilon = {self.epsilon}: must be positive and finite")

    @property
    def kind(self) -> int:
        """Number of the kernel in compiled code."""
        return KERNELS[self.kernel][0]

    @property
    def degree(self) -> int:
        """Degree of the polynomial."""
        return KERNELS[self.kernel][1]

    @property
    def cells(self) -> int:
        """Number of grid nodes, C."""
        return int(np.prod(self.shape))

    @property
    def terms(self) -> int:
        """Number of coefficients of a map: C and those of the polynomial."""
        return self.cells + 1 + self.degree * len(self.shape)

    @cached_property
    def nodes(self) -> Array:
        """(C, P) grid nodes, grid steps."""
        return np.indices(self.shape, dtype=float).reshape(len(self.shape), -1).T.copy()

    def basis(self, steps: ArrayLike) -> Array:
        """Value of every term at (L, P) points, (L, terms): ``f = basis @ coefficients``."""
        from scipy.spatial.distance import cdist  # late: a process that only samples never solves

        points = np.atleast_2d(np.asarray(steps, dtype=float))
        radial = kernels.apply(self.kind, self.epsilon**2 * cdist(points, self.nodes, "sqeuclidean"))
        half = (np.array(self.shape) - 1) / 2
        polynomial = np.column_stack([np.ones(len(points)), (points - half) / half])[:, : self.terms - self.cells]
        return np.concatenate([radial, polynomial], axis=1)

    @cached_property
    def _matrix(self) -> Array:
        upper = self.basis(self.nodes)
        extra = self.terms - self.cells
        return np.block([[upper], [upper[:, self.cells :].T, np.zeros((extra, extra))]])

    @cached_property
    def _factors(self) -> tuple[Array, NDArray[np.int32]]:
        from scipy.linalg import lu_factor

        return lu_factor(self._matrix)

    def coefficients(self, maps: ArrayLike) -> Array:
        """Coefficients of (N, C) maps, (N, terms); the system is factorised once per interpolant."""
        values = np.atleast_2d(np.asarray(maps, dtype=float))
        if values.shape[1] != self.cells:
            raise InputError(
                f"maps have {values.shape[1]} cells, the parameter grid {self.cells}: they belong to different spaces"
            )
        from scipy.linalg import lu_solve

        padded = np.zeros((self.terms, len(values)), order="F")
        padded[: self.cells] = values.T
        return np.ascontiguousarray(lu_solve(self._factors, padded, overwrite_b=True, check_finite=False).T)

    def evaluate(self, coefficients: ArrayLike, steps: ArrayLike) -> Array:
        """The interpolated map at (L, P) points in grid steps, (L,); neither clipped nor sharpened."""
        points = np.ascontiguousarray(np.atleast_2d(steps), dtype=float)
        return kernels.values(np.ascontiguousarray(coefficients, dtype=float), points, *self.compiled)

    @property
    def compiled(self) -> tuple[NDArray[np.int64], int, float, int]:
        """What compiled code needs: shape, kernel number, epsilon, degree."""
        return np.array(self.shape, dtype=np.int64), self.kind, float(self.epsilon), self.degree

    @cached_property
    def inverse_diagonal(self) -> Array:
        """(C,) diagonal of the inverse system, for Rippa's leave-one-out errors ``e_i = c_i / (A^-1)_ii`` (Rippa 1999)."""
        from scipy.linalg import lu_solve

        inverse = lu_solve(self._factors, np.eye(self.terms), check_finite=False)
        return np.diagonal(inverse)[: self.cells].copy()


Interpolant = GridInterpolant | MultilinearInterpolant


def interpolant_named(basis: Basis, shape: tuple[int, ...], kernel: Kernel = "multiquadric", epsilon: float = 1.0) -> Interpolant:
    """The paper's radial basis functions (``rbf``, with a kernel and its width) or the ``multilinear`` basis.

    Raises
    ------
    InputError
        If there is no basis or kernel of that name.
    """
    if basis == "rbf":
        return GridInterpolant(shape, kernel, epsilon)
    if basis == "multilinear":
        return MultilinearInterpolant(shape)
    raise InputError(f"basis: there is no {basis!r}; choose rbf or multilinear")
