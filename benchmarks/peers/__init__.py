"""Other libraries behind one face: `peer.functions(arm, file)` maps names to batch functions.

A batch function takes (rows, n) arrays q, qd, x and returns the rows of results, flat; "order" is
an array, our joints in the order of the peer's. A peer that cannot be had here raises ImportError
or AbsentError from its import or from `functions`.
"""


class AbsentError(Exception):
    """Why a peer is not measured here."""
