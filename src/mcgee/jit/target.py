"""The processor that kernels are compiled for."""

from __future__ import annotations

import platform
from dataclasses import dataclass, replace
from functools import cache


@dataclass(frozen=True)
class Target:
    triple: str
    cpu: str
    features: str
    lanes: int
    """Values in one vector register."""
    fma: bool
    """Whether a multiply-add with one rounding is one instruction."""
    arm64: bool = False
    bits: int = 64
    """Of one value: a float64 or a float32."""

    @property
    def single(self) -> Target:
        """The same processor, computing with float32."""
        return replace(self, bits=32, lanes=2 * self.lanes)

    @property
    def size(self) -> int:
        """Bytes of one value."""
        return self.bits // 8

    @property
    def element(self) -> str:
        """LLVM's name for the type of one value."""
        return {64: "double", 32: "float"}[self.bits]

    @property
    def vector(self) -> str:
        return f"<{self.lanes} x {self.element}>"


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
