"""Between rows in memory and tiles: the loops of a gufunc that move data, as LLVM IR.

A tile's worth of contiguous rows moves b scalars of each at a time through a transpose of vectors
(@pack, @unpack); everything else moves scalar by scalar (@gather, @scatter).
"""

from collections.abc import Sequence

from mcgee.graph.program import Array
from mcgee.jit.emit import hexadecimal
from mcgee.jit.target import Target

AHEAD = 256
"""Bytes ahead of a row's results that memory is asked for: lines come while others are written."""


def common_ir(target: Target, inputs: int) -> str:
    """@gather, @scatter, @nans to find rows with NaN among the inputs, and @poison for them."""
    return _COMMON.format(
        w=target.lanes,
        t=target.element,
        size=target.size,
        nan=hexadecimal(float("nan"), target.bits),
        search="\n  ".join(_nans(target, inputs)),
    )


def _nans(target: Target, inputs: int) -> list[str]:
    """Two vectors a comparison, which is unordered where either holds a NaN."""
    v, mask = target.vector, f"<{target.lanes} x i1>"
    lines = []
    for i in range(inputs):
        lines.append(f"%at.{i} = getelementptr {v}, ptr %tile, i64 {i}")
        lines.append(f"%x.{i} = load {v}, ptr %at.{i}, align {target.size}")
    found = []
    for i in range(0, inputs, 2):
        found.append(f"%nan.{i}")
        lines.append(f"%nan.{i} = fcmp uno {v} %x.{i}, %x.{min(i + 1, inputs - 1)}")
    while len(found) > 1:
        a, b, *found = found
        found.append(f"%any.{len(lines)}")
        lines.append(f"{found[-1]} = or {mask} {a}, {b}")
    return [*lines, f"%bits = bitcast {mask} {found[0]} to i{target.lanes}"]


def _shuffle(a: str, b: str, t: str, size: int, mask: Sequence[int]) -> str:
    v, indices = f"<{size} x {t}>", ", ".join(f"i32 {m}" for m in mask)
    return f"shufflevector {v} {a}, {v} {b}, <{len(mask)} x i32> <{indices}>"


def _transpose(names: list[str], t: str, w: int) -> tuple[list[str], list[str]]:
    """Turn b vectors of w lanes about the diagonal of each group of b lanes."""
    lines, step, b = [], 1, len(names)
    while step < b:
        turned = list(names)
        for i in range(b):
            if not i & step:
                low = [j if not j & step else w + j - step for j in range(w)]
                high = [j + step if not j & step else w + j for j in range(w)]
                for mask, place in ((low, i), (high, i + step)):
                    turned[place] = f"%turn{step}.{place}"
                    shuffle = _shuffle(names[i], names[i + step], t, w, mask)
                    lines.append(f"{turned[place]} = {shuffle}")
        names, step = turned, step * 2
    return lines, names


def _joined(t: str, w: int, b: int) -> tuple[list[str], list[str]]:
    """Rows %row.0 … of b scalars, joined to b vectors: i holds rows i, i + b, … side by side."""
    lines, names, size = [], [f"%row.{i}" for i in range(w)], b
    while size < w:
        half = len(names) // 2
        joined = [f"%join{size}.{i}" for i in range(half)]
        for i in range(half):
            shuffle = _shuffle(names[i], names[i + half], t, size, range(2 * size))
            lines.append(f"{joined[i]} = {shuffle}")
        names, size = joined, size * 2
    if w // b > 2:  # halving paired rows i and i + w/2: put the groups in order
        order = _bit_reversed_groups(w // b)
        mask = [order.index(g) * b + c for g in range(w // b) for c in range(b)]
        for i in range(b):
            lines.append(f"%order.{i} = {_shuffle(names[i], names[i], t, w, mask)}")
        names = [f"%order.{i}" for i in range(b)]
    return lines, names


def _bit_reversed_groups(count: int) -> list[int]:
    """The order in which joining halves leaves the groups."""
    order = [[g] for g in range(count)]
    while len(order) > 1:
        half = len(order) // 2
        order = [order[i] + order[i + half] for i in range(half)]
    return order[0]


def copies_ir(target: Target, b: int) -> str:
    """@pack and @unpack for whole tiles of contiguous rows of b scalars or more."""
    w, t, v, size = target.lanes, target.element, target.vector, target.size
    row = f"<{b} x {t}>"
    rows, load_rows = [], []
    for i in range(w):
        rows += [
            f"%skip.{i} = mul i64 %outer, {i}",
            f"%at.{i} = getelementptr i8, ptr %first, i64 %skip.{i}",
        ]
        load_rows.append(f"%row.{i} = load {row}, ptr %at.{i}, align {size}")
    joins, joined = _joined(t, w, b)
    turns, turned = _transpose(joined, t, w)
    store_tile = []
    for c in range(b):
        store_tile += [
            f"%column.{c} = add i64 %e, {c}",
            f"%to.{c} = getelementptr {v}, ptr %tile, i64 %column.{c}",
            f"store {v} {turned[c]}, ptr %to.{c}, align {size}",
        ]
    pack = rows + load_rows + joins + turns + store_tile
    load_tile = []
    for c in range(b):
        load_tile += [
            f"%column.{c} = add i64 %e, {c}",
            f"%slot_at.{c} = getelementptr i32, ptr %slots, i64 %column.{c}",
            f"%slot.{c} = load i32, ptr %slot_at.{c}",
            f"%wide.{c} = zext i32 %slot.{c} to i64",
            f"%from.{c} = getelementptr {v}, ptr %tile, i64 %wide.{c}",
            f"%in.{c} = load {v}, ptr %from.{c}, align {size}",
        ]
    turns, turned = _transpose([f"%in.{c}" for c in range(b)], t, w)
    store_rows = _stores(turned, target, b)
    unpack = rows + load_tile + turns + store_rows
    chunks = {"pack_chunk": "\n  ".join(pack), "unpack_chunk": "\n  ".join(unpack)}
    return _COPIES.format(w=w, b=b, t=t, size=size, shift=size.bit_length() - 1, **chunks)


def _stores(turned: list[str], target: Target, b: int) -> list[str]:
    """Each row's chunk out of the turned vectors, and a word to memory about the next."""
    lines = []
    for i in range(target.lanes):
        group = [i - i % b + c for c in range(b)]
        chunk_of_row = _shuffle(turned[i % b], turned[i % b], target.element, target.lanes, group)
        lines += [
            f"%ahead.{i} = getelementptr i8, ptr %at.{i}, i64 {AHEAD}",
            f"call void @llvm.prefetch(ptr %ahead.{i}, i32 1, i32 3, i32 1)",
            f"%row.{i} = {chunk_of_row}",
            f"store <{b} x {target.element}> %row.{i}, ptr %at.{i}, align {target.size}",
        ]
    return lines


def chunk(array: Array, w: int) -> int:
    """The scalars of a row that move at once: the largest power of two that fits."""
    return 1 << (min(array.size, w).bit_length() - 1)


# the last chunk overlaps the one before it
_CHUNKS = """
  br label %chunk
chunk:
  %e = phi i64 [ 0, %0 ], [ %en, %chunk ]
  %bytes = shl i64 %e, {shift}
  %first = getelementptr i8, ptr %at, i64 %bytes
  {CHUNK}
  %end = sub i64 %size, {b}
  %ended = icmp eq i64 %e, %end
  %e2 = add i64 %e, {b}
  %en = call i64 @llvm.umin.i64(i64 %e2, i64 %end)
  br i1 %ended, label %done, label %chunk
done:
  ret void
}}
"""

# for each element (i, j, k) of the core, for each lane
_ELEMENTS = """ noinline cold nounwind {{
  %dij = mul i64 %di, %dj
  %size = mul i64 %dij, %dk
  br label %loop
loop:
  %x = phi i64 [ 0, %0 ], [ %xn, %step ]
  %i = phi i64 [ 0, %0 ], [ %in_, %step ]
  %j = phi i64 [ 0, %0 ], [ %jn, %step ]
  %k = phi i64 [ 0, %0 ], [ %kn, %step ]
  %oi = mul i64 %i, %si
  %oj = mul i64 %j, %sj
  %ok = mul i64 %k, %sk
  %oij = add i64 %oi, %oj
  %o = add i64 %oij, %ok
  %element = getelementptr i8, ptr %at, i64 %o
  br label %lane
lane:
  %l = phi i64 [ 0, %loop ], [ %ln, %lane_end ]
  {LANE}
  %ln = add i64 %l, 1
  %lmore = icmp ult i64 %ln, {LANES}
  br i1 %lmore, label %lane, label %step
step:
  %xn = add i64 %x, 1
  %k1 = add i64 %k, 1
  %kc = icmp eq i64 %k1, %dk
  %kn = select i1 %kc, i64 0, i64 %k1
  %jinc = zext i1 %kc to i64
  %j1 = add i64 %j, %jinc
  %jc = icmp eq i64 %j1, %dj
  %jn = select i1 %jc, i64 0, i64 %j1
  %iinc = zext i1 %jc to i64
  %in_ = add i64 %i, %iinc
  %more = icmp ult i64 %xn, %size
  br i1 %more, label %loop, label %done
done:
  ret void
}}
"""

_GATHER = """
  %r0 = sub i64 %rows, 1
  %r = call i64 @llvm.umin.i64(i64 %l, i64 %r0)
  %ro = mul i64 %r, %outer
  %src = getelementptr i8, ptr %element, i64 %ro
  %value = load {t}, ptr %src, align {size}
  %x0 = mul i64 %x, {w}
  %xl = add i64 %x0, %l
  %dst = getelementptr {t}, ptr %tile, i64 %xl
  store {t} %value, ptr %dst, align {size}
  br label %lane_end
lane_end:
"""

_SCATTER = """
  %ro = mul i64 %l, %outer
  %dst = getelementptr i8, ptr %element, i64 %ro
  %sp = getelementptr i32, ptr %slots, i64 %x
  %slot = load i32, ptr %sp
  %wide = zext i32 %slot to i64
  %x0 = mul i64 %wide, {w}
  %xl = add i64 %x0, %l
  %src = getelementptr {t}, ptr %tile, i64 %xl
  %value = load {t}, ptr %src, align {size}
  store {t} %value, ptr %dst, align {size}
  br label %lane_end
lane_end:
"""

_POISON = """
  %shifted = lshr i64 %bad, %l
  %bit = trunc i64 %shifted to i1
  br i1 %bit, label %write, label %lane_end
write:
  %ro = mul i64 %l, %outer
  %dst = getelementptr i8, ptr %element, i64 %ro
  store {t} {nan}, ptr %dst, align {size}
  br label %lane_end
lane_end:
"""

_ROWS = "ptr %at, i64 %outer, i64 %rows, i64 %di, i64 %dj, i64 %dk, i64 %si, i64 %sj, i64 %sk"

_COPIES = (
    "define internal void @pack{b}(ptr %at, i64 %outer, i64 %size, ptr %tile) noinline nounwind {{"
    + _CHUNKS.replace("{CHUNK}", "{pack_chunk}")
    + """
define internal void @unpack{b}(ptr %at, i64 %outer, i64 %size, ptr %tile, ptr %slots)
    noinline nounwind {{"""
    + _CHUNKS.replace("{CHUNK}", "{unpack_chunk}")
)

_COMMON = (
    """
declare i64 @llvm.umin.i64(i64, i64)
declare void @llvm.prefetch(ptr, i32, i32, i32)

define internal i64 @nans(ptr %tile) noinline nounwind {{
  {search}
  %wide = zext i{w} %bits to i64
  ret i64 %wide
}}
"""
    + f"\ndefine internal void @gather({_ROWS}, ptr %tile)"
    + _ELEMENTS.replace("{LANE}", _GATHER).replace("{LANES}", "{w}")
    + f"\ndefine internal void @scatter({_ROWS}, ptr %tile, ptr %slots)"
    + _ELEMENTS.replace("{LANE}", _SCATTER).replace("{LANES}", "%rows")
    + f"\ndefine internal void @poison({_ROWS}, i64 %bad)"
    + _ELEMENTS.replace("{LANE}", _POISON).replace("{LANES}", "%rows")
)
