"""Symmetric positive definite systems over any scalar, unrolled: LDLᵀ without pivoting."""

from collections.abc import Sequence

from mcgee.scalar import Scalar

Rows = list[list[Scalar]]


def factor(M: Sequence[Sequence[Scalar]]) -> tuple[Rows, list[Scalar]]:
    """(L, 1/D) with M = Lᵀ D L, L unit lower triangular.

    Eliminating from the leaves keeps the zeros that branches leave in M. Source: Featherstone
    2008, table 6.3.
    """
    n = len(M)
    H = [list(row) for row in M]
    L: Rows = [[0] * n for _ in range(n)]
    d_inverse: list[Scalar] = [0] * n
    for k in reversed(range(n)):
        d_inverse[k] = 1 / H[k][k]
        for i in reversed(range(k)):
            L[k][i] = H[k][i] * d_inverse[k]
            for j in range(i + 1):
                H[i][j] = H[i][j] - L[k][i] * H[k][j]
    return L, d_inverse


def solve(M: Sequence[Sequence[Scalar]], b: Sequence[Scalar]) -> list[Scalar]:
    """M⁻¹ b."""
    return _solved(*factor(M), b)


def solve_columns(M: Sequence[Sequence[Scalar]], b: Sequence[Sequence[Scalar]]) -> Rows:
    """M⁻¹ b for a matrix b: no more products than by M⁻¹, and fewer where branches left zeros."""
    factors = factor(M)
    columns = [_solved(*factors, column) for column in zip(*b, strict=True)]
    return [list(row) for row in zip(*columns, strict=True)]


def _solved(L: Rows, d_inverse: Sequence[Scalar], b: Sequence[Scalar]) -> list[Scalar]:
    n, x = len(b), list(b)
    for i in reversed(range(n)):
        for j in range(i):
            x[j] = x[j] - L[i][j] * x[i]
    for i in range(n):
        x[i] = x[i] * d_inverse[i]
        for j in range(i):
            x[i] = x[i] - L[i][j] * x[j]
    return x


def inverse(M: Sequence[Sequence[Scalar]]) -> Rows:
    """M⁻¹ = L⁻¹ D⁻¹ L⁻ᵀ, symmetric to the last bit."""
    L, d_inverse = factor(M)
    n = len(M)
    # A = L⁻¹, unit lower triangular
    A: Rows = [[1 if i == j else 0 for j in range(n)] for i in range(n)]
    for i in range(n):
        for j in range(i):
            for k in range(j, i):
                A[i][j] = A[i][j] - L[i][k] * A[k][j]
    W = [[A[i][k] * d_inverse[k] for k in range(n)] for i in range(n)]
    out: Rows = [[0] * n for _ in range(n)]
    for i in range(n):
        for j in range(i + 1):
            total: Scalar = 0
            for k in range(j + 1):
                total = total + W[i][k] * A[j][k]
            out[i][j] = out[j][i] = total
    return out
