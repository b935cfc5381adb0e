"""Writes straight-line LLVM IR on vectors of floating-point numbers, one value a name."""

from __future__ import annotations

import ctypes
import struct
from dataclasses import dataclass, field

from mcgee.jit.target import Target


def hexadecimal(value: float, bits: int = 64) -> str:
    """A float64, or the float32 nearest to it, as LLVM reads both, to the last bit."""
    if bits == 32:
        value = ctypes.c_float(value).value
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"


@dataclass
class Emitter:
    target: Target
    lines: list[str] = field(default_factory=list)
    _names: int = 0

    @property
    def vector(self) -> str:
        return self.target.vector

    @property
    def integers(self) -> str:
        return f"<{self.target.lanes} x i{self.target.bits}>"

    @property
    def suffix(self) -> str:
        return f"v{self.target.lanes}f{self.target.bits}"

    def constant(self, value: float) -> str:
        """A constant operand, the same in every lane."""
        return self._splat(f"{self.target.element} {hexadecimal(value, self.target.bits)}")

    def integer(self, value: int) -> str:
        return self._splat(f"i{self.target.bits} {value}")

    def _splat(self, element: str) -> str:
        return "<" + ", ".join([element] * self.target.lanes) + ">"

    def splat(self, scalar: str) -> str:
        """A named scalar in every lane."""
        v, w = self.vector, self.target.lanes
        one = self.let(f"insertelement {v} poison, {self.target.element} {scalar}, i64 0")
        zeros = f"<{w} x i32> zeroinitializer"
        return self.let(f"shufflevector {v} {one}, {v} poison, {zeros}")

    def let(self, text: str) -> str:
        """Name a value."""
        self._names += 1
        name = f"%t{self._names}"
        self.lines.append(f"  {name} = {text}")
        return name

    def do(self, text: str) -> None:
        self.lines.append(f"  {text}")

    def load(self, array: str, index: int) -> str:
        place = self._at(array, index)
        return self.let(f"load {self.vector}, ptr {place}, align {self.target.size}")

    def store(self, value: str, array: str, index: int) -> None:
        place = self._at(array, index)
        self.do(f"store {self.vector} {value}, ptr {place}, align {self.target.size}")

    def _at(self, array: str, index: int) -> str:
        return self.let(f"getelementptr {self.vector}, ptr {array}, i64 {index}")

    def add(self, a: str, b: str) -> str:
        return self.let(f"fadd {self.vector} {a}, {b}")

    def sub(self, a: str, b: str) -> str:
        return self.let(f"fsub {self.vector} {a}, {b}")

    def mul(self, a: str, b: str) -> str:
        return self.let(f"fmul {self.vector} {a}, {b}")

    def div(self, a: str, b: str) -> str:
        return self.let(f"fdiv {self.vector} {a}, {b}")

    def neg(self, a: str) -> str:
        return self.let(f"fneg {self.vector} {a}")

    def muladd(self, a: str, b: str, c: str) -> str:
        """a b + c, with one rounding where the processor has it."""
        if not self.target.fma:
            return self.add(self.mul(a, b), c)
        v = self.vector
        return self.let(f"call {v} @llvm.fma.{self.suffix}({v} {a}, {v} {b}, {v} {c})")

    def mulsub(self, a: str, b: str, c: str) -> str:
        """a b − c."""
        return self.muladd(a, b, self.neg(c)) if self.target.fma else self.sub(self.mul(a, b), c)

    def submul(self, c: str, a: str, b: str) -> str:
        """c − a b."""
        return self.muladd(self.neg(a), b, c) if self.target.fma else self.sub(c, self.mul(a, b))

    def horner(self, x: str, coefficients: tuple[float, ...]) -> str:
        """The polynomial with its highest coefficient first."""
        value = self.constant(coefficients[0])
        for coefficient in coefficients[1:]:
            value = self.muladd(value, x, self.constant(coefficient))
        return value
