"""The processor that kernels are compiled for."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from functools import cache


@dataclass(frozen=True)
class Target:
    triple: str
    cpu: str
    features: str
    lanes: int
    """float64 values in one vector register."""
    fma: bool
    """Whether a multiply-add with one rounding is one instruction."""
    arm64: bool = False


@cache
def host() -> Target:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features()
    return Target(
        triple=llvm.get_process_triple(),
        cpu=llvm.get_host_cpu_name(),
        features=features.flatten(),
        lanes=_lanes(features),
        fma=bool(features.get("fma")) or _is_arm64(),
        arm64=_is_arm64(),
    )


def _is_arm64() -> bool:
    return platform.machine().lower() in ("arm64", "aarch64")


def _lanes(features: dict[str, bool]) -> int:
    if features.get("avx512f") and features.get("avx512dq"):
        return 8
    return 4 if features.get("avx") else 2
