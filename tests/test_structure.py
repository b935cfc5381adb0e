"""The tree's own rules: which folder may import which, how long things may be, lint and types."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "mcgee"

# what each part of the pipeline may import, besides itself; everything may import errors
MAY_IMPORT = {
    "errors": [],
    "scalar": [],
    "model": ["scalar"],
    "mechanism": ["model", "scalar"],
    "validate": ["mechanism", "model", "scalar"],
    "algorithms": ["mechanism", "model", "scalar"],
    "quantities": ["algorithms", "mechanism", "model", "scalar"],
    "graph": [],
    "build": ["algorithms", "graph", "mechanism", "quantities"],
    "jit": ["graph", "trigonometry"],
    "threads": [],
    "kernels": ["build", "graph", "jit", "threads", "mechanism"],
    "parametric": ["build", "kernels", "mechanism", "robot"],
    "robot": [  # closed_form, codegen, explain and parametric when asked
        *("algorithms", "build", "closed_form", "codegen", "explain", "kernels", "mechanism"),
        *("model", "parametric", "scalar", "validate"),
    ],
    "formats": ["arms", "model", "robot", "scalar", "validate"],  # arms by name, when asked
    "arms": ["formats", "model", "robot", "scalar"],
    "typeset": [],
    "closed_form": [
        *("algorithms", "mechanism", "model", "quantities", "robot", "scalar", "writing"),
    ],
    "explain": ["mechanism", "model", "quantities", "robot", "typeset", "writing"],
    "writing": [],
    "trigonometry": [],
    "codegen": [
        *("algorithms", "arms", "build", "closed_form", "graph", "mechanism", "quantities"),
        *("kernels", "robot", "scalar", "trigonometry", "writing"),
    ],
    "audit": ["robot"],
    "control": ["kernels", "mechanism", "model", "robot"],
    "simulate": ["control", "explain", "kernels", "mechanism", "robot", "typeset", "writing"],
    "cli": [  # algorithms: classic ones
        *("algorithms", "audit", "build", "closed_form", "codegen", "control", "explain"),
        *("kernels", "robot", "simulate", "typeset", "writing"),
    ],
}
LINES_OF_FILE, LINES_OF_FUNCTION = 400, 40


def modules():
    return sorted(SOURCE.rglob("*.py"))


def part(path: Path) -> str:
    return path.relative_to(SOURCE).parts[0].removesuffix(".py")


def imported(path: Path) -> set[str]:
    parts = set()
    for node in ast.walk(ast.parse(path.read_text())):
        names = []
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module] if node.module != "mcgee" else []
            names += [f"mcgee.{alias.name}" for alias in node.names if node.module == "mcgee"]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        parts |= {name.split(".")[1] for name in names if name.startswith("mcgee.")}
    return parts


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(SOURCE)))
def test_arrows_point_one_way(path):
    if part(path) in ("__init__", "__main__"):
        return
    allowed = {part(path), "errors", *MAY_IMPORT[part(path)]}
    assert imported(path) <= allowed


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(SOURCE)))
def test_files_and_functions_are_short(path):
    text = path.read_text()
    reasoned = "Longer than" in text  # the reason stands in the file
    assert len(text.splitlines()) <= LINES_OF_FILE or reasoned
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef):
            docstring = ast.get_docstring(node) or ""
            length = node.end_lineno - node.lineno + 1 - len(docstring.splitlines())
            assert length <= LINES_OF_FUNCTION, f"{node.name} has {length} lines"


def run(*command: str):
    result = subprocess.run(
        [sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True
    )
    assert result.returncode == 0, result.stdout + result.stderr


def test_lint():
    run("ruff", "check", ".")


def test_format():
    run("ruff", "format", "--check", ".")


def test_types():
    run("mypy")


def test_import_is_light():
    """`import mcgee` loads neither the compiler nor parsers nor plotting."""
    code = "import sys, mcgee; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout
    heavy = {"llvmlite", "lxml", "sympy", "flint", "typer", "rich", "scipy", "plotly"}
    assert not heavy & set(loaded.split())
