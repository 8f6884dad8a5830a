"""The rows of the method's energy as sparse matrices of SciPy's. For study."""

from __future__ import annotations

import sys
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from meshgraft import _core
from meshgraft._adapters import adapt
from meshgraft._calls import DEFAULT, Progress, calling
from meshgraft._docs_of import documented
from meshgraft._records import OperatorKeywords, StencilNodes

if sys.version_info >= (3, 11):
    from typing import Unpack
else:
    from typing_extensions import Unpack

__all__ = ["AffineOperator"]


def _sparse() -> Any:
    try:
        import scipy.sparse
    except ImportError:
        raise ImportError("the operator's matrices need SciPy: pip install scipy") from None
    return scipy.sparse


def csr(parts: Any) -> Any:
    """Returns a matrix by rows."""
    data, indices, offsets, shape = parts
    return _sparse().csr_array((data, indices, offsets), shape=shape)


def csc(parts: Any) -> Any:
    """Returns a matrix by columns."""
    data, indices, offsets, shape = parts
    return _sparse().csc_array((data, indices, offsets), shape=shape)


@documented("AffineOperator")
class AffineOperator:
    """The operator over a mesh without constraints; `Deformer.affine_operator` has that of a deformation.

    Matrices are scipy.sparse.csr_array.
    """

    _core: Any

    def __init__(self, mesh: Any, *, threads: int = 0, progress: Progress = None,
                 **options: Unpack[OperatorKeywords]) -> None:
        own = adapt(mesh).mesh
        triangles = own if own.is_triangular else own.triangulated()
        with calling(threads, None, progress) as call:
            self._core = _core.affine_operator(own.vertices, triangles.faces, dict(options), call)

    @classmethod
    def _wrap(cls, core: Any) -> AffineOperator:
        operator = cls.__new__(cls)
        operator._core = core
        return operator

    @property
    def L(self) -> Any:
        """Rows of E_L x nodes."""
        return csr(self._core.L())

    @property
    def delta(self) -> Any:
        """Rows of E_L x 3n."""
        return csr(self._core.delta())

    @property
    def H(self) -> Any:
        """3n x nodes: the local maps that positions have."""
        return csr(self._core.H())

    @property
    def P(self) -> Any:
        """Rows of E_R x 3n."""
        return csr(self._core.P())

    @documented("AffineOperator.A")
    def A(self) -> Any:
        """Returns the rows of the whole energy over all nodes."""
        return csr(self._core.A(DEFAULT))

    @documented("AffineOperator.coupling")
    def coupling(self) -> Any:
        """Returns PᵀP, 3n x 3n."""
        return csr(self._core.coupling(DEFAULT))

    @property
    def pairs(self) -> NDArray[np.int32]:
        """The pairs of vertices of E_R, (k, 2)."""
        return cast("NDArray[np.int32]", self._core.pairs())

    @property
    def edge_lengths(self) -> NDArray[np.float64]:
        """Mean length of the edges at each vertex, (n,)."""
        return cast("NDArray[np.float64]", self._core.edge_lengths())

    @property
    def mean_edge_length(self) -> float:
        """The mean of `edge_lengths`."""
        return cast(float, self._core.mean_edge_length())

    @property
    def nodes(self) -> StencilNodes:
        """The nodes that local maps are fitted to: vertices, then apexes."""
        return cast(StencilNodes, self._core.nodes())
