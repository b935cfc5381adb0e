"""Every command and every example of README.md and docs/ runs."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
README = (ROOT / "README.md").read_text()


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(), re.DOTALL)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_python_examples_run_in_order(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scope: dict = {}
    for block in blocks(page, "python"):
        exec(compile(block, str(page), "exec"), scope)


COMMANDS = [
    line.removeprefix("$ ")
    for block in blocks(ROOT / "README.md", "console")
    for line in block.splitlines()
    if line.startswith("$ ")
]


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_run(command, tmp_path):
    program, *words = command.split()
    assert program == "mcgee"
    path = Path(sys.executable).with_name("mcgee")
    result = subprocess.run([path, *words], capture_output=True, text=True, cwd=tmp_path)
    assert result.returncode == 0
    assert all(line.startswith("mcgee: wrote ") for line in result.stderr.splitlines())


def test_demo_explains_both_arms(tmp_path):
    """`make demo`, with what it installs already there."""
    result = subprocess.run(["make", "-n", "demo"], cwd=ROOT, capture_output=True, text=True)
    lines = result.stdout.replace("\\\n", " ").splitlines()
    commands = [line.split() for line in lines if line.startswith(".venv/bin/mcgee")]
    assert len(commands) == 2
    for _, *words in commands:
        page = tmp_path / words.pop()
        words = [str(ROOT / word) if word.endswith(".urdf") else word for word in words]
        path = Path(sys.executable).with_name("mcgee")
        run = subprocess.run([path, *words, page], capture_output=True, text=True)
        assert run.returncode == 0
        assert "M(q)" in run.stdout
        assert page.stat().st_size > 1000


def test_the_test_command_is_what_ci_calls():
    assert "make test" in README
    assert (ROOT / ".ci" / "run").read_text().rstrip().endswith("make test")


def test_picture_is_what_the_command_prints():
    sys.path.insert(0, str(ROOT / "docs"))
    try:
        import picture
    finally:
        sys.path.pop(0)
    assert words_of(picture.TARGET.read_text()) == words_of(picture.picture())


def words_of(svg: str) -> list[str]:
    return re.sub(r"<style>.*?</style>|<[^>]*>", " ", svg, flags=re.DOTALL).split()


def test_links_lead_somewhere():
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"


def test_builtin_arms_are_listed():
    import mcgee

    for name in mcgee.arms.BUILTIN:
        assert f"`{name}`" in README
