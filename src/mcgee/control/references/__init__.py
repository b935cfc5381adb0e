"""Where the joints shall be at each time: a position, polynomials, trapezoids, Fourier series."""

from mcgee.control.references.fourier import Fourier
from mcgee.control.references.polynomials import Quintic, Trapezoidal
from mcgee.control.references.reference import Constant, Desired, Extremes, Reference

__all__ = [
    "Constant",
    "Desired",
    "Extremes",
    "Fourier",
    "Quintic",
    "Reference",
    "Trapezoidal",
]
