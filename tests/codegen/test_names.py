"""Names of any alphabet become identifiers of every language, and harm nobody."""

from __future__ import annotations

import keyword
import re
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mcgee.codegen.names import LONGEST, RESERVED, Names, camel, identifier, pascal, stem, words

LEGAL = re.compile(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*_?")


@given(st.text(max_size=80))
def test_identifiers_are_legal_everywhere(name):
    found = identifier(name)
    assert LEGAL.fullmatch(found)
    assert "__" not in found
    assert len(found) <= LONGEST + 3
    assert found not in RESERVED
    assert not keyword.iskeyword(found)


@given(st.lists(st.text(max_size=12), max_size=30))
def test_no_two_names_share_an_identifier(given_names):
    names = Names()
    found = [names.of(name) for name in given_names]
    assert len({x.replace("_", "").lower() for x in found}) == len(found)
    assert all(LEGAL.fullmatch(x) for x in found)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("planar_2r", "planar_2r"),
        ("l1", "l1"),
        ("I1", "I1"),
        ("θ1", "theta1"),
        ("Ω", "Omega"),
        ("größe", "grou00dfe"),
        ("2r", "x_2r"),
        ("", "x"),
        ("***", "x"),
        ("class", "class_"),
        ("lambda", "lambda_"),
        ("I", "I_"),
        ("q", "q_"),
        ("my arm (left)", "my_arm_left"),
        ("a__b", "a_b"),
        ("机器人", "u673au5668u4eba"),
        ('x"; system("rm -rf /"); //', "x_system_rm_rf"),
    ],
)
def test_what_names_become(name, expected):
    assert identifier(name) == expected


@pytest.mark.parametrize("name", ["NAN", "INFINITY", "M_PI", "DBL_EPSILON", "UINT64_MAX"])
def test_macros_of_headers_are_no_names(name):
    assert identifier(name) == f"{name}_"
    assert stem(name) == f"{name}_arm"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("planar_2r", "planar_2r"),
        ("2r", "arm_2r"),
        ("", "arm"),
        ("class", "class_arm"),
        ("math", "math_arm"),
        ("String", "String_arm"),
        ("SELF_TEST", "SELF_TEST_arm"),
        ("fmi3Functions", "fmi3Functions_arm"),
    ],
)
def test_robots_hide_no_file(name, expected):
    assert stem(name) == expected


def test_every_module_of_python_is_known():
    for name in sys.stdlib_module_names:
        if "_" not in name and name == name.lower():
            assert stem(name) == f"{name}_arm"


def test_collisions_are_numbered():
    names = Names()
    assert [names.of(x) for x in ("a b", "a_b", "A.B", "ab")] == ["a_b", "a_b_2", "A_B_3", "ab_4"]


def test_forms():
    assert pascal("planar_2r") == "Planar2r"
    assert camel("inverse_dynamics") == "inverseDynamics"


HOSTILE = [
    "*/ int x; /*",
    '""" + __import__("os").system("x") + """',
    "\\u000a System.exit(1); //",
    "line\nbreak\r\u2028\u2029end",
    "(* Quit[] *)",
    "%{ block %}",
    "]]> <x/> -->",
    "trailing backslash \\",
    "`backticks` ${HOME} $(x) #{x} <%= x %>",
    "??/ trigraph",
]


@pytest.mark.parametrize("name", HOSTILE)
def test_words_end_no_comment(name):
    said = words(name)
    assert said.isascii()
    assert said.isprintable()
    for ending in ("*", "\\", '"', "'", "\n", "%", "#", "<", ">", "`", "$", "{", "}", "?", ";"):
        assert ending not in said


@given(st.text(max_size=300))
def test_words_are_of_few_characters(name):
    assert re.fullmatch(r"[A-Za-z0-9 _.,:+()-]{1,200}", words(name))
