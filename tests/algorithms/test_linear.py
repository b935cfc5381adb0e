"""LᵀDL over fractions, where equal means equal."""

from fractions import Fraction

import numpy as np
import pytest

from mcgee.algorithms.linear import factor, inverse, solve


def positive_definite(n, rng):
    A = rng.integers(-5, 6, (n, n))
    M = A.T @ A + np.eye(n, dtype=int)
    return [[Fraction(int(x)) for x in row] for row in M]


def product(A, B):
    return [
        [sum(a * b for a, b in zip(row, column, strict=True)) for column in zip(*B, strict=True)]
        for row in A
    ]


def diagonal(values):
    return [[v if i == j else 0 for j in range(len(values))] for i, v in enumerate(values)]


@pytest.mark.parametrize("n", [1, 2, 5])
def test_factor(n, rng):
    M = positive_definite(n, rng)
    strict, d_inverse = factor(M)
    L = [[1 if i == j else strict[i][j] for j in range(n)] for i in range(n)]
    transposed = [list(row) for row in zip(*L, strict=True)]
    assert product(product(transposed, diagonal([1 / d for d in d_inverse])), L) == M
    assert all(L[i][j] == 0 for i in range(n) for j in range(i + 1, n))


@pytest.mark.parametrize("n", [1, 2, 5])
def test_solve_and_inverse(n, rng):
    M = positive_definite(n, rng)
    x = [Fraction(int(v), 3) for v in rng.integers(-9, 10, n)]
    b = [sum(a * v for a, v in zip(row, x, strict=True)) for row in M]
    given = list(b)
    assert solve(M, b) == x
    assert b == given  # left as it was
    assert product(inverse(M), M) == diagonal([1] * n)


def test_zeros_of_branches_survive():
    """Two leaves on one root: eliminating from the leaves fills nothing in."""
    M = [
        [Fraction(9), Fraction(2), Fraction(3)],
        [Fraction(2), Fraction(4), 0],
        [Fraction(3), 0, 5],
    ]
    L, _ = factor(M)
    assert L[2][1] == 0
