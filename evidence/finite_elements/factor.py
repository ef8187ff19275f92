"""The direct solver of the linear systems: Pardiso where it is installed, else SuperLU."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix
from scipy.sparse.linalg import splu

try:
    from pypardiso import PyPardisoSolver
    from pypardiso.pardiso_wrapper import PyPardisoError
except ImportError:  # SuperLU does the same, but more slowly
    PyPardisoSolver = None
    PyPardisoError = RuntimeError


class Factor:
    """Sparse symmetric solver with a fixed pattern."""

    def __init__(self, indptr, indices):
        self.indptr, self.indices, self.n = indptr, indices, len(indptr) - 1
        self._solver = PyPardisoSolver(mtype=-2) if PyPardisoSolver else None
        self._analysed = False
        self._rows = np.repeat(np.arange(self.n), np.diff(indptr))
        self._diagonal = indptr[:-1]  # the first entry of each row of the upper triangle

    def solve(self, data, b):
        # Entries grow with the radius, and PARDISO compares pivots with the largest entry.
        scale = 1 / np.sqrt(np.abs(data[self._diagonal]))
        data = data * scale[self._rows] * scale[self.indices]
        return scale * self._solve(data, scale * b)

    def _solve(self, data, b):
        A = csr_matrix((data, self.indices, self.indptr), shape=(self.n, self.n))
        if self._solver is None:
            diagonal = csr_matrix((A.diagonal(), (range(self.n), range(self.n))))
            return splu(csc_matrix(A + A.T - diagonal)).solve(b)
        if not self._analysed:
            self._solver.set_phase(11)
            self._solver._call_pardiso(A, b)
            self._analysed = True
        self._solver.set_phase(23)
        try:
            return self._solver._call_pardiso(A, b)
        except PyPardisoError as error:
            raise RuntimeError(str(error)) from error

    def close(self):
        if self._solver is not None:
            self._solver.free_memory(everything=True)
