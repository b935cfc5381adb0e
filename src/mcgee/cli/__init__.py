"""The command `mcgee`."""

from mcgee.cli.app import main

__all__ = ["main"]
