"""Damaged URDF texts: whatever the damage, only a ModelError comes out, in one line."""

import copy
import warnings

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree
from urdf_text import ELBOW, arm, read

from mcgee import ModelError, ModelWarning

RICH = arm(
    ELBOW + '<dynamics damping="1" friction="2"/><mimic joint="shoulder" multiplier="2"/>',
    more='<link name="tip"/><joint name="flange" type="fixed"><parent link="fore"/>'
    '<child link="tip"/><origin xyz="0 0 1" rpy="1.57079632679 0 0"/></joint>',
)
NUMBERS_OR_NOT = [
    "",
    " ",
    "0",
    "-1",
    "nan",
    "inf",
    "1e999",
    "1e308",
    "1e-308",
    "1_0",
    "٣",
    "&",
    "\n",
    "${x}",
]
VECTORS = ["0 0 0", "1e308 1e308 1e308", "0 9e307 0", "1.57 1.57 1.57", "1e-320 0 0"]
NAMES = ["base", "upper", "fore", "elbow", "shoulder", "fixed", "floating"]
WORDS = [*NUMBERS_OR_NOT, *VECTORS, *NAMES]
VALUES = st.sampled_from(WORDS) | st.text(
    st.characters(codec="utf-8", categories=["L", "N", "P", "S", "Zs"]), max_size=9
)


def quietly(text) -> None:
    """Only a ModelError may come out, and every message is one line."""
    messages = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            read(text)
        except ModelError as error:
            messages = [str(error)]
    assert all(w.category is ModelWarning for w in caught)
    assert all(m.isprintable() for m in (*messages, *(str(w.message) for w in caught)))


@pytest.mark.parametrize("word", WORDS)
def test_each_attribute_with_each_word_raises_nothing_but_model_errors(word):
    root = etree.fromstring(RICH)
    for element in root.iter(etree.Element):
        for name, written in element.attrib.items():
            element.set(name, word)
            quietly(etree.tostring(root))
            element.set(name, written)


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_mutated_trees_raise_nothing_but_model_errors(data):
    root = etree.fromstring(RICH)
    for _ in range(data.draw(st.integers(1, 3))):
        element = data.draw(st.sampled_from(list(root.iter(etree.Element))))
        action = data.draw(st.sampled_from(["delete", "duplicate", "rename", "drop", "alter"]))
        parent = element.getparent()
        if action == "delete" and parent is not None:
            parent.remove(element)
        elif action == "duplicate" and parent is not None:
            parent.append(copy.deepcopy(element))
        elif action == "rename":
            element.tag = data.draw(st.sampled_from(["robot", "joint", "axis", "{u}x", "sdf"]))
        elif action in ("drop", "alter") and element.attrib:
            name = data.draw(st.sampled_from(list(element.attrib)))
            if action == "drop":
                del element.attrib[name]
            else:
                element.set(name, data.draw(VALUES))
    quietly(etree.tostring(root))


@settings(max_examples=300, deadline=None)
@given(st.integers(0, len(RICH)), st.integers(0, 9), st.binary(max_size=6))
def test_mutated_bytes_raise_nothing_but_model_errors(at, dropped, inserted):
    content = RICH.encode()
    quietly(content[:at])
    quietly(content[:at] + inserted + content[at + dropped :])


@settings(max_examples=200, deadline=None)
@given(st.text() | st.binary())
def test_any_text_raises_nothing_but_model_errors(text):
    quietly(text)
