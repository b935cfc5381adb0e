"""The physical meaning of M, C and g: figures first, renderings apart."""

from mcgee.explain.explanation import Explanation, explain

__all__ = ["Explanation", "explain"]
