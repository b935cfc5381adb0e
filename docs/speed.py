"""Draws docs/images/speed.svg from the benchmark's results: `python docs/speed.py`."""

import json
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROBOTS = {"ur5": "UR5", "panda": "Panda", "talos": "Talos, 32 joints"}
COLOURS = {"ur5": "#2563eb", "panda": "#d97706", "talos": "#059669"}
FUNCTIONS = {
    "inverse_dynamics": "inverse dynamics",
    "forward_dynamics": "forward dynamics",
    "mass_matrix": "M(q)",
    "coriolis_matrix": "C(q, qd)",
    "gravity": "g(q)",
    "inverse_dynamics_derivatives": "∂ inverse",
    "forward_dynamics_derivatives": "∂ forward",
}
LEFT, WIDE, BAR, GAP, TOP = 150, 520, 11, 14, 58


def ratios(tables: dict, robot: str) -> dict[str, float]:
    rows = {line["function"]: line["ns"] for line in tables[robot]}
    return {f: rows[f]["pinocchio_cpp"] / rows[f]["mcgee"] for f in FUNCTIONS if f in rows}


def drawn(tables: dict) -> str:
    found = {robot: ratios(tables, robot) for robot in ROBOTS}
    scale = WIDE / max(max(row.values()) for row in found.values())
    parts, y = [], TOP
    for function, label in FUNCTIONS.items():
        middle = y + len(ROBOTS) * BAR / 2 + 4
        parts.append(f'<text x="{LEFT - 10}" y="{middle}" text-anchor="end">{label}</text>')
        for robot, row in found.items():
            length = row[function] * scale
            parts.append(
                f'<rect x="{LEFT}" y="{y}" width="{length:.1f}" height="{BAR - 2}" rx="2" '
                f'fill="{COLOURS[robot]}"/><text class="n" x="{LEFT + length + 5:.1f}" '
                f'y="{y + BAR - 3}">{row[function]:.0f}×</text>'
            )
            y += BAR
        y += GAP
    x = LEFT
    for robot, label in ROBOTS.items():
        parts.append(f'<rect x="{x}" y="34" width="10" height="10" fill="{COLOURS[robot]}"/>')
        parts.append(f'<text x="{x + 15}" y="43">{label}</text>')
        x += 40 + 8 * len(label)
    title = "Evaluations a second, in batches, against Pinocchio in C++ (one thread each)"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {LEFT + WIDE + 60} {y}" '
        f'font-family="system-ui, sans-serif" font-size="13" role="img" aria-label="{title}">'
        "<style>text{fill:#1f2937}.n{font-size:10px}"
        "@media(prefers-color-scheme:dark){text{fill:#e5e7eb}}</style>"
        f'<text x="10" y="20" font-weight="600">{title}</text>{"".join(parts)}</svg>\n'
    )


if __name__ == "__main__":
    results = json.loads((ROOT / "benchmarks" / "results.json").read_text())
    (ROOT / "docs" / "images" / "speed.svg").write_text(drawn(results["tables"]))
