"""Checks of robots: the laws that every equation of motion obeys (`mcgee.audit.laws`)."""

from mcgee.audit import laws

__all__ = ["laws"]
