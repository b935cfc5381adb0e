"""What symbols are called on paper: lc1 is l with the subscript c1, qd1 is q₁ with a dot."""

from __future__ import annotations

import re
from dataclasses import dataclass

INDEXED = re.compile(r"\b([A-Za-z]|q|qd)_([ijk]{1,3})\b")
"""In sentences: M_ij, qd_j."""

GREEK = {
    **{"alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ"},
    **{"eta": "η", "theta": "θ", "iota": "ι", "kappa": "κ", "mu": "μ", "nu": "ν"},
    **{"xi": "ξ", "pi": "π", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ"},
    **{"chi": "χ", "psi": "ψ", "omega": "ω", "Gamma": "Γ", "Delta": "Δ", "Theta": "Θ"},
    **{"Xi": "Ξ", "Pi": "Π", "Sigma": "Σ", "Phi": "Φ", "Psi": "Ψ", "Omega": "Ω"},
}


@dataclass(frozen=True)
class Written:
    letter: str
    """One letter, or the name of a Greek one."""
    subscript: str
    dots: int = 0


def written(name: str, is_rate: bool = False) -> Written | None:
    """How the name is written; None where it is no letters with digits or an underscore."""
    rate = re.fullmatch(r"q(d{1,2})(\d+)", name)
    if is_rate and rate:
        return Written("q", rate[2], len(rate[1]))
    parts = re.fullmatch(r"([A-Za-z]+)_?([A-Za-z0-9]*)", name)
    if parts is None:
        return None
    letters, rest = parts[1], parts[2]
    if letters in GREEK or len(letters) == 1:
        return Written(letters, rest)
    return Written(letters[0], letters[1:] + rest)
