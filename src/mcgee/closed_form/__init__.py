"""Closed forms of the equation of motion: exact trigonometric polynomials, formulas and proofs."""

from mcgee.closed_form.form import ClosedForm, closed_form
from mcgee.closed_form.lagrange import lagrange

__all__ = ["ClosedForm", "closed_form", "lagrange"]
