"""M, C, g and the rest as polynomials: the algorithms on a ring, and derivatives of M and P."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from sympy import Symbol

from mcgee.closed_form.ring import Polynomial, Ring

Row = list[Polynomial]
Rows = list[Row]


@dataclass(frozen=True)
class Dynamics:
    """What M, g, T and P say of a system, as polynomials; lists of n, n by n, n by n by n."""

    ring: Ring
    q: tuple[Symbol, ...]
    qd: tuple[Symbol, ...]
    qdd: tuple[Symbol, ...]
    M: Rows
    g: Row
    T: Polynomial
    P: Polynomial
    constants: dict[Symbol, float]
    """The values of named angles [rad]."""

    @property
    def n(self) -> int:
        return len(self.q)

    @cached_property
    def slopes(self) -> list[Rows]:
        """∂M_ij/∂q_k at [k][i][j]."""
        return [_symmetric(self.n, lambda i, j, s=s: self.M[i][j].derivative(s)) for s in self.q]

    @cached_property
    def christoffel(self) -> list[Rows]:
        """c_ijk = ½(∂M_ij/∂q_k + ∂M_ik/∂q_j − ∂M_jk/∂q_i)."""
        dM = self.slopes
        return [
            _symmetric(self.n, lambda j, k, i=i: (dM[k][i][j] + dM[j][i][k] - dM[i][j][k]) / 2)
            for i in range(self.n)
        ]

    @cached_property
    def C(self) -> Rows:
        """C_ij = Σ_k c_ijk qd_k."""
        return [[self._dot(self._qd, c_ij) for c_ij in c_i] for c_i in self.christoffel]

    @cached_property
    def Cqd(self) -> Row:
        return [self._dot(self._qd, row) for row in self.C]

    @cached_property
    def tau(self) -> Row:
        """M qdd + C qd + g."""
        qdd = [self.ring.symbol(s) for s in self.qdd]
        return [
            self._dot(qdd, row) + b + g for row, b, g in zip(self.M, self.Cqd, self.g, strict=True)
        ]

    @property
    def _qd(self) -> Row:
        return [self.ring.symbol(s) for s in self.qd]

    def _dot(self, a: Sequence[Polynomial], b: Sequence[Polynomial]) -> Polynomial:
        total = self.ring(0)
        for x, y in zip(a, b, strict=True):
            if y:
                total = total + x * y
        return total


def _symmetric(n: int, entry) -> Rows:  # type: ignore[no-untyped-def]
    half = [[entry(i, j) for j in range(i + 1)] for i in range(n)]
    return [[half[max(i, j)][min(i, j)] for j in range(n)] for i in range(n)]
