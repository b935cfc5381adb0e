"""Every language, in its real toolchain: textbook arms and robots, broken code, golden files."""

from __future__ import annotations

import dataclasses
import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest
from units import FUNCTIONS, made

import mcgee
from mcgee.codegen import LANGUAGES, VerificationError, fmu_description
from mcgee.codegen.common import Files
from mcgee.codegen.language import Language, Tool
from mcgee.codegen.unit import unit
from mcgee.codegen.verify import Verification, verify
from robots import random_tree

GOLDEN = Path(__file__).parent / "golden"
ROBOTS = ["planar_2r", "puma560", "ur5", "panda"]

ULP = 4.0
"""Units in the last place of a result's scale, against 60 digits."""

CODE = [name for name in LANGUAGES if name not in ("fmu", "wolfram")]
"""Those that write any function; the other two have tests of their own."""


@cache
def files(target: str, *of, **kinds) -> Files:
    return LANGUAGES[target].files(made(*of, **kinds))


def tried(target: str, robot_unit) -> Verification:
    language = LANGUAGES[target]
    done = verify(language, robot_unit, language.files(robot_unit))
    if done.missing:
        pytest.skip(f"no {done.missing}")
    return done


@pytest.mark.parametrize("params", [False, True], ids=["compiled", "parametric"])
@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("target", CODE)
def test_terms_are_right(target, name, params):
    functions = ("terms", "inverse_dynamics", "forward_dynamics")
    done = tried(target, made(name, functions, params))
    assert [a.function for a in done.agreements] == ["dynamics", *functions[1:]]
    for a in done.agreements:
        assert a.states == a.kernel_states == 20
        assert a.exact <= ULP
        assert a.kernel <= 2 * ULP


@pytest.mark.parametrize("params", [False, True], ids=["compiled", "parametric"])
@pytest.mark.parametrize("target", CODE)
def test_every_shape_of_result(target, params):
    """Numbers, vectors, matrices, tensors, several at once, and functions in parts."""
    robot = made("ur5", FUNCTIONS, params)
    assert any(len(f.routine.parts) > 1 for f in robot.functions)
    for a in tried(target, robot).agreements:
        assert a.exact <= ULP


@pytest.mark.parametrize("target", CODE)
def test_sliding_and_coupled_joints_of_hostile_names(target):
    arm = random_tree(12, bodies=6, prismatic=0.4, mimic=0.3)
    joints = tuple(
        dataclasses.replace(j, name=f'{j.name} */ """ \\u000a %}} "x"; // {k}')
        for k, j in enumerate(arm.joints)
    )
    names = dict(zip((j.name for j in arm.joints), (j.name for j in joints), strict=True))
    joints = tuple(
        j
        if j.mimic is None
        else dataclasses.replace(j, mimic=dataclasses.replace(j.mimic, joint=names[j.mimic.joint]))
        for j in joints
    )
    arm = dataclasses.replace(arm, name='class */ "ä (* $(reboot) %}', joints=joints)
    robot = unit(arm, ("terms", "jacobian"), False, {}, arm.end_frame, False)
    assert robot.name == "class_a_reboot"
    for a in tried(target, robot).agreements:
        assert a.exact <= ULP


@pytest.mark.parametrize("name", ["NAME_TESTS_CALLS_VECTORS", "REACH ROUND EXACT"])
@pytest.mark.parametrize("target", CODE)
def test_words_of_templates_are_names_like_others(target, name):
    arm = mcgee.arms.planar_2r().replace(name=f"{name} SCALAR COUNT")
    robot = unit(arm, ("inverse_dynamics",), True, {}, arm.end_frame, False)
    for a in tried(target, robot).agreements:
        assert a.exact <= ULP


@pytest.mark.parametrize("target", [name for name in CODE if LANGUAGES[name].floats])
def test_float(target):
    robot = made("panda", ("terms", "forward_dynamics"), single=True)
    for a in tried(target, robot).agreements:
        assert a.exact <= ULP


# -- broken code ----------------------------------------------------------------------------------

SOURCES = {
    "python": "planar_2r.py",
    "c": "planar_2r.c",
    "cpp": "planar_2r.hpp",
    "java": "Planar2rDynamics.java",
    "matlab": "planar_2r_dynamics.m",
    "simulink": "planar_2r.c",
    "javascript": "planar_2r.js",
}


@pytest.mark.parametrize("target", CODE)
def test_a_wrong_sign_is_found(target):
    robot = made("planar_2r", params=True)
    found = dict(files(target, "planar_2r", params=True))
    text = found[SOURCES[target]]
    assert isinstance(text, str)
    found[SOURCES[target]] = text.replace("2.0*q", "-2.0*q", 1)
    assert found[SOURCES[target]] != text
    with pytest.raises(VerificationError):
        verify(LANGUAGES[target], robot, found)


@pytest.mark.parametrize("target", CODE)
def test_a_wrong_default_is_found(target):
    robot = made("planar_2r", params=True)
    found = dict(files(target, "planar_2r", params=True))
    holds = "planar_2r_params.m" if target in ("matlab", "simulink") else SOURCES[target]
    text = str(found[holds])
    found[holds] = re.sub(r"(g0.*)9\.81", r"\g<1>9.82", text)
    if found[holds] == text:  # C lists them without their names
        found[holds] = text.replace("9.81", "9.82")
    assert found[holds] != text
    with pytest.raises(VerificationError):
        verify(LANGUAGES[target], robot, found)


@pytest.mark.parametrize("target", CODE)
def test_a_wrong_vector_is_found(target):
    robot = made("planar_2r", params=True)
    found = dict(files(target, "planar_2r", params=True))
    first, *others = str(found["vectors/dynamics.txt"]).splitlines(keepends=True)
    numbers = first.split()
    numbers[-4] = repr(float(numbers[-4]) + 1e-9)  # the last element of g
    found["vectors/dynamics.txt"] = "".join([" ".join(numbers) + "\n", *others])
    with pytest.raises(VerificationError):
        verify(LANGUAGES[target], robot, found)


@pytest.mark.parametrize("target", CODE)
def test_nan_is_found(target):
    robot = made("planar_2r", params=True)
    found = dict(files(target, "planar_2r", params=True))
    text = str(found[SOURCES[target]])
    q = "q(1)" if target == "matlab" else "q[0]"
    found[SOURCES[target]] = text.replace("2.0*q", f"(0.0/({q} - {q}))*q", 1)
    with pytest.raises(VerificationError):
        verify(LANGUAGES[target], robot, found)


@pytest.mark.parametrize("target", CODE)
@pytest.mark.parametrize("text", ["", "1.0 2.0\n"])
def test_vectors_that_are_not_there_are_missed(target, text):
    robot = made("planar_2r", params=True)
    found = dict(files(target, "planar_2r", params=True)) | {"vectors/dynamics.txt": text}
    with pytest.raises(VerificationError):
        verify(LANGUAGES[target], robot, found)


def test_a_missing_toolchain_is_said():
    c = LANGUAGES["c"]
    absent = Language(
        "c", "C", c.files, (Tool(("mcgee-cc", "mcgee-gcc"), get="apt install it"),), c.build, c.run
    )
    robot = made("planar_2r", params=True)
    done = verify(absent, robot, c.files(robot))
    assert not done.done
    assert done.missing == "mcgee-cc or mcgee-gcc (apt install it)"


# -- golden files ---------------------------------------------------------------------------------


SHARED = re.compile(r"vectors/.*|fmu/(sources/fm.*|selftest.py|README.md)")
"""What is no text about this arm; an FMU's README names the machine."""


def golden(target: str) -> Files:
    """The planar 2R arm with its parameters open, and folded in."""
    functions = LANGUAGES[target].functions or ("terms", "inverse_dynamics")
    kinds = {"parametric": True, "compiled": False}
    if LANGUAGES[target].parametric:
        del kinds["compiled"]
    found = {
        f"{kind}/{path}": content
        for kind, params in kinds.items()
        for path, content in files(target, "planar_2r", functions, params=params).items()
        if isinstance(content, str)
        and not SHARED.fullmatch(path)
        and not SHARED.fullmatch(f"{target}/{path}")
    }
    if target == "fmu":
        robot = made("planar_2r", functions, params=True)
        for version in (2, 3):
            path = f"parametric/modelDescription{version}.xml"
            found[path] = fmu_description.model_description(robot, version)
    return found


@pytest.mark.parametrize("target", LANGUAGES)
def test_golden_files(target):
    """Write them anew with: python tests/codegen/test_languages.py"""
    kept = GOLDEN / target
    found = {str(p.relative_to(kept)): p.read_text() for p in kept.rglob("*") if p.is_file()}
    assert found == golden(target)


# -- C and C++ ------------------------------------------------------------------------------------


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(
    "flags",
    [
        "-O0",
        "-O3 -march=native",
        "-Os",
        "-O2 -ffast-math",
        "-O2 -funsafe-math-optimizations",
        "-O3 -fassociative-math -fno-signed-zeros -fno-trapping-math",
    ],
)
def test_c_holds_under_other_flags(flags, compiler, tmp_path):
    """Fast mathematics too, which would undo the reduction of angles."""
    robot = made("ur5", ("inverse_dynamics", "terms"))
    for path, content in files("c", "ur5", ("inverse_dynamics", "terms")).items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(str(content))
    found = Tool((compiler, *(f"{compiler}-{version}" for version in range(22, 13, -1)))).found()
    if found is None:
        pytest.skip(f"no {compiler}")
    subprocess.run(
        [found, "-std=c99", "-Werror", *flags.split(), "selftest.c", f"{robot.name}.c", "-lm"],
        cwd=tmp_path,
        check=True,
    )
    assert subprocess.run(["./a.out"], cwd=tmp_path).returncode == 0


@pytest.mark.parametrize("target", ["c", "cpp"])
def test_doubles_of_four_bytes(target, tmp_path):
    """As some microcontrollers have them: the library's cosines then, and no bits of others."""
    made_files = files(target, "planar_2r")
    for path, content in made_files.items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(re.sub(r"\bdouble\b", "float", str(content)))
    source = "planar_2r.c" if target == "c" else "planar_2r.hpp"
    text = (tmp_path / source).read_text()
    (tmp_path / source).write_text(text.replace("DBL_MANT_DIG", "FLT_MANT_DIG"))
    main = {
        "c": "#include <stdio.h>\n"
        '#include "planar_2r.h"\n'
        "int main(void) {\n"
        "    const float q[] = {0.5f, 0.3f}, qd[] = {0.0f, 0.0f};\n"
        "    float M[4], b[2], g[2];\n"
        "    planar_2r_dynamics(q, qd, M, b, g);\n"
        '    printf("%.6f\\n", M[0]);\n}\n',
        "cpp": "#include <cstdio>\n"
        '#include "planar_2r.hpp"\n'
        "int main() {\n"
        "    Eigen::Matrix<float, 2, 1> q(0.5f, 0.3f), qd(0, 0), b, g;\n"
        "    Eigen::Matrix<float, 2, 2> M;\n"
        "    planar_2r_dynamics(q, qd, M, b, g);\n"
        '    std::printf("%.6f\\n", static_cast<double>(M(0, 0)));\n}\n',
    }[target]
    (tmp_path / f"main.{target}").write_text(main)
    compile_ = {
        "c": ["gcc", "-std=c99", "main.c", "planar_2r.c"],
        "cpp": ["g++", "-std=c++14", "-isystem", "/usr/include/eigen3", "main.cpp"],
    }[target]
    flags = ["-Wall", "-Werror", "-fsanitize=address,undefined", "-O1", "-lm"]
    subprocess.run([*compile_, *flags], cwd=tmp_path, check=True)
    said = subprocess.run(["./a.out"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert float(said.stdout) == pytest.approx(2.655336, abs=2e-6)


@pytest.mark.parametrize("target", ["c", "cpp"])
def test_cmake_builds_and_tests(target, tmp_path):
    for path, content in files(target, "planar_2r", params=True).items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(str(content))
    for command in (
        ["cmake", "-S", ".", "-B", "build", "-DCMAKE_BUILD_TYPE=Release"],
        ["cmake", "--build", "build"],
        ["ctest", "--test-dir", "build", "--output-on-failure"],
    ):
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
    assert "100% tests passed" in done.stdout


def test_c_headers_are_for_cpp_too(tmp_path):
    for path, content in files("c", "planar_2r", params=True).items():
        if path.endswith((".c", ".h")):
            (tmp_path / path).write_text(str(content))
    (tmp_path / "main.cpp").write_text(
        '#include "planar_2r.h"\nint main() {\n'
        "  double q[2] = {0.5, 0.3}, v[2] = {0.1, -0.2}, M[4], C[2], g[2];\n"
        "  planar_2r_dynamics(q, v, &planar_2r_defaults, M, C, g);\n"
        "  return M[1] != M[2];\n}\n"
    )
    flags = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run(["gcc", *flags, "-std=c99", "-c", "planar_2r.c"], cwd=tmp_path, check=True)
    subprocess.run(["g++", *flags, "main.cpp", "planar_2r.o", "-lm"], cwd=tmp_path, check=True)
    assert subprocess.run(["./a.out"], cwd=tmp_path).returncode == 0


def test_c_allocates_nothing_and_calls_only_mathematics(tmp_path):
    for path, content in files("c", "panda", ("forward_dynamics",)).items():
        if path.endswith((".c", ".h")):
            (tmp_path / path).write_text(str(content))
    subprocess.run(["gcc", "-O2", "-c", "panda.c"], cwd=tmp_path, check=True)
    done = subprocess.run(
        ["nm", "-u", "panda.o"], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    needs = {line.split()[-1] for line in done.stdout.splitlines()}
    assert needs <= {"cos", "sin", "sincos", "_GLOBAL_OFFSET_TABLE_", "__stack_chk_fail"}


# -- Java -----------------------------------------------------------------------------------------


def test_java_methods_are_short_enough_for_the_compiler(tmp_path):
    """HotSpot leaves methods beyond 8,000 bytes of bytecode to its interpreter."""
    functions = ("forward_dynamics_derivatives", "regressor", "christoffel")
    source = files("java", "panda", functions)["PandaDynamics.java"]
    (tmp_path / "PandaDynamics.java").write_text(str(source))
    subprocess.run(["javac", "PandaDynamics.java"], cwd=tmp_path, check=True)
    done = subprocess.run(
        ["javap", "-c", "-p", "PandaDynamics.class"],
        cwd=tmp_path,
        check=True,
        capture_output=True,
        text=True,
    )
    offsets = [
        int(line.strip().partition(":")[0])
        for line in done.stdout.splitlines()
        if line.strip().partition(":")[0].isdigit()
    ]
    assert len(offsets) > 10_000
    assert max(offsets) < 8000


# -- Python ---------------------------------------------------------------------------------------


@pytest.fixture
def module(tmp_path, monkeypatch):
    mcgee.arms.planar_2r().codegen("python", tmp_path / "p", ["terms", "kinetic_energy"])
    monkeypatch.syspath_prepend(str(tmp_path / "p"))
    sys.modules.pop("planar_2r", None)
    import planar_2r

    return planar_2r


def test_python_broadcasts(module, rng):
    q, qd = rng.normal(size=(3, 1, 2)), rng.normal(size=(5, 2))
    arm = mcgee.arms.planar_2r()
    for got, want in zip(module.planar_2r_dynamics(q, qd), arm.terms(q, qd), strict=True):
        assert got.shape == want.shape
        assert abs(got - want).max() <= 1e-14 * abs(want).max()
    T = module.planar_2r_kinetic_energy(q, qd)
    assert T.shape == (3, 5)
    assert isinstance(module.planar_2r_kinetic_energy([0, 0], [1, 2]), float)


def test_python_says_what_is_wrong(module):
    with pytest.raises(ValueError, match=r"q has shape \(3,\), expected \(..., 2\)"):
        module.planar_2r_dynamics([0, 0, 0], [0, 0])


def test_python_nan_is_that_rows_alone(module, rng):
    import numpy as np

    q, qd = rng.normal(size=(2, 4, 2))
    q[2, 1] = np.nan
    M, Cqd, g = module.planar_2r_dynamics(q, qd)
    assert np.isnan(g[2]).all()
    assert np.isfinite(g[[0, 1, 3]]).all()
    assert np.isfinite(M[[0, 1, 3]]).all()
    assert np.isfinite(Cqd[[0, 1, 3]]).all()


if __name__ == "__main__":
    shutil.rmtree(GOLDEN, ignore_errors=True)
    for language in LANGUAGES:
        for path, content in golden(language).items():
            (GOLDEN / language / path).parent.mkdir(parents=True, exist_ok=True)
            (GOLDEN / language / path).write_text(str(content))
