"""The C++ that `mcgee codegen` writes, a call a row, on vectors of Eigen."""

import ctypes
from pathlib import Path

from mcgee import build
from mcgee.codegen import c, cpp
from mcgee.codegen.unit import Unit, unit
from peers import compiler, pinocchio_cpp
from peers.generated_c import BUILD, FUNCTIONS, bound

NAME = "generated C++"
LOOP = """
extern "C" void batch(
    const double* x0, const double* x1, const double* x2, double* y, long rows) {{
  (void)x1; (void)x2;
{vectors}
  for (long i = 0; i < rows; ++i) {{
{reads}    {call};
{writes}  }}
}}
"""


def loop(made: Unit) -> str:
    """As Pinocchio's: a row's states are copied to aligned vectors, and its results from them."""
    (f,) = made.functions
    arrays = (*f.inputs, *f.outputs)
    vectors = "\n".join(f"  {cpp.kind(made, a)} {a.name};" for a in arrays)
    reads = "".join(
        f"    std::memcpy({a.name}.data(), x{k} + i * {a.size}, {8 * a.size});\n"
        for k, a in enumerate(f.inputs)
    )
    size, at, writes = sum(a.size for a in f.outputs), 0, ""
    for a in f.outputs:
        writes += f"    std::memcpy(y + i * {size} + {at}, {a.name}.data(), {8 * a.size});\n"
        at += a.size
    call = f"{c.symbol(made, f)}({', '.join(a.name for a in arrays)})"
    return LOOP.format(vectors=vectors, reads=reads, writes=writes, call=call)


def generated(arm, name: str, build_with: str) -> tuple[ctypes.CDLL, int]:
    made = unit(arm, [name], False, {}, arm.end_frame, False)
    folder = BUILD / f"cpp-{made.fingerprint[:12]}-{name}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{made.name}.hpp").write_text(cpp.header_file(made))
    source = folder / "batch.cpp"
    source.write_text(f'#include "{made.name}.hpp"\n#include <cstring>\n' + loop(made))
    library = folder / f"{build_with}.so"
    library.unlink(missing_ok=True)
    flags = ("-std=c++17", f"-I{pinocchio_cpp.eigen()}")
    compiler.built(build_with, source, library, *flags)
    return ctypes.CDLL(str(library)), sum(a.size for a in made.functions[0].outputs)


def functions(arm, file: Path, build_with: str | None = None) -> dict:
    made_by = build_with or compiler.cpp()
    return {
        name: bound(lambda name=name: generated(arm, name, made_by))
        for name in FUNCTIONS
        if name in build.SIGNATURES
    }
