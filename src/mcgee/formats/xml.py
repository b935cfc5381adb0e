"""XML from outside, read with care: nothing is opened, nothing expanded, every message one line.

A description is untrusted input. It may declare no DOCTYPE and so no entities; numbers are plain
finite decimals, names printable and of bounded length, so that any message may hold them. Messages
start with 'arm.urdf:12: ', the file's base name and the line.
"""

from __future__ import annotations

import io
import math
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from lxml import etree

from mcgee.errors import ModelError

SIZE_LIMIT = 64 << 20  # bytes; the largest robot description we know of has 0.2 MB
NAME_LIMIT = 256  # characters
NUMBER_LIMIT = 100  # characters; a double needs 24

# Python's own float() also takes 1_000, the digits of other scripts, nan and inf
_NUMBER = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_INFINITY = re.compile(r"[-+]?inf(?:inity)?", re.IGNORECASE)
_BLANK = re.compile(r"[ \t\r\n]+")


# -- files ----------------------------------------------------------------------------------------


def read_file(path: str | os.PathLike[str]) -> bytes:
    """The content of a file of reasonable size."""
    name = shown(os.fsdecode(path))
    try:
        with open(path, "rb") as stream:
            return stream.read(SIZE_LIMIT + 1)
    except FileNotFoundError:
        raise ModelError(f"{name} does not exist, expected the path of a robot's file.") from None
    except IsADirectoryError:
        raise ModelError(f"{name} is a directory, expected the path of a robot's file.") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ModelError(f"{name} cannot be read: {reason}.") from None


class _NoDoctype:
    """A first pass that stops at a DOCTYPE, before any entity in it is declared."""

    def doctype(self, *_: Any) -> None:
        raise ModelError(
            "has a DOCTYPE. A robot description needs none, and entities are not expanded: "
            "remove it."
        )

    def close(self) -> None:
        pass


def parse(text: str | bytes, file: str) -> Node:
    """The root element, from a parser that opens no file and expands no entity."""
    file = plain(file)
    content = text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text
    if len(content) > SIZE_LIMIT:
        raise ModelError(f"{file} is larger than {SIZE_LIMIT >> 20} MiB, expected a robot's file.")
    if not content.strip():
        raise ModelError(f"{file} is empty, expected a robot's file.")
    options: dict[str, Any] = {
        "encoding": "utf-8" if isinstance(text, str) else None,
        "resolve_entities": False,
        "no_network": True,
        "load_dtd": False,
        "dtd_validation": False,
        "huge_tree": False,
    }
    try:
        etree.parse(io.BytesIO(content), etree.XMLParser(target=_NoDoctype(), **options))
        element = etree.parse(io.BytesIO(content), etree.XMLParser(**options)).getroot()
    except ModelError as error:
        raise ModelError(f"{file} {error}") from None
    except etree.XMLSyntaxError as error:
        problem = re.sub(r"\s*, line \d+, column \d+.*$", "", error.msg or "", flags=re.DOTALL)
        hint = f" {expand_xacro()}" if "prefix xacro" in problem else ""
        raise ModelError(
            f"{file}:{error.lineno or 1}: is not well-formed XML: {plain(problem)}.{hint}"
        ) from None
    return Node(element, file, element.nsmap.get(None))


# -- texts from outside ---------------------------------------------------------------------------


def plain(text: str) -> str:
    """A text from outside on one line: control characters escaped, long texts cut."""
    text = text if len(text) <= NAME_LIMIT else text[: NAME_LIMIT - 1] + "…"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def shown(text: str) -> str:
    return f"'{plain(text)}'"


def expand_xacro(file: str = "FILE.xacro") -> str:
    """What to do with a file that is still xacro."""
    stem = re.sub(r"(\.urdf)?\.xacro$", "", file, flags=re.IGNORECASE)
    return f"Expand it first: xacro {plain(file)} > {plain(stem)}.urdf"


def _is_number(word: str, infinite: bool) -> bool:
    if infinite and _INFINITY.fullmatch(word):
        return True
    decimal = len(word) <= NUMBER_LIMIT and _NUMBER.fullmatch(word)
    return bool(decimal) and math.isfinite(float(word))


# -- elements -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Node:
    """An element, and where it stands."""

    element: Any
    file: str
    namespace: str | None = None
    """The document's default namespace; a name from another keeps its prefix."""
    owner: str = ""
    """What it belongs to, for messages: "joint 'elbow'"."""
    is_owner: bool = False

    def named(self, owner: str) -> Node:
        """This element, known in messages by that name, and those below it with it."""
        return replace(self, owner=owner, is_owner=True)

    @property
    def line(self) -> int:
        return self.element.sourceline

    @property
    def place(self) -> str:
        return f"{self.file}:{self.line}: "

    @property
    def tag(self) -> str:
        name = etree.QName(self.element)
        own = name.namespace in (None, self.namespace)
        return name.localname if own else f"{self.element.prefix}:{name.localname}"

    @property
    def what(self) -> str:
        """arm.urdf:12: joint 'elbow': <limit>"""
        if self.is_owner:
            return self.place + self.owner
        return f"{self.place}{self.owner}{': ' if self.owner else ''}<{plain(self.tag)}>"

    def error(self, problem: str) -> ModelError:
        return ModelError(f"{self.what} {problem}")

    def children(self) -> Iterator[Node]:
        """The elements directly below; comments and processing instructions are none."""
        for element in self.element.iterchildren(etree.Element):
            yield replace(self, element=element, is_owner=False)

    def all(self, tag: str) -> list[Node]:
        return [child for child in self.children() if child.tag == tag]

    def only(self, tag: str) -> Node | None:
        """The one child of that name, if any. Two are refused: some readers take the first, some
        the last, and the physics would hang on which."""
        found = self.all(tag)
        if len(found) > 1:
            raise found[1].error(f"is there twice, first on line {found[0].line}. Remove one.")
        return found[0] if found else None

    def one(self, tag: str) -> Node:
        child = self.only(tag)
        if child is None:
            raise self.error(f"has no <{tag}>, expected one.")
        return child

    def attributes(self) -> list[str]:
        return list(self.element.attrib)

    def text(self, attribute: str, default: str | None = None) -> str:
        text = self.element.get(attribute, default)
        if text is None:
            raise self.error(f'has no {attribute}, expected <{self.tag} {attribute}="…">.')
        return text

    def name(self, attribute: str) -> str:
        """A name that any message may hold as it is: printable, of bounded length."""
        name = self.text(attribute)
        if not name.strip():
            raise self.error(f"has {attribute} {shown(name)}, expected a name that is not empty.")
        if len(name) > NAME_LIMIT or not name.isprintable():
            raise self.error(
                f"has {attribute} {shown(name)}, expected at most {NAME_LIMIT} characters, "
                f"all of them printable."
            )
        return name

    def words(
        self, attribute: str, count: int, default: str | None = None, infinite: bool = False
    ) -> list[str]:
        """The decimal numbers in an attribute, as written."""
        text = self.text(attribute, default)
        words = [word for word in _BLANK.split(text) if word]
        if len(words) == count and all(_is_number(word, infinite) for word in words):
            return words
        want = "a finite number such as 0.5"
        if count > 1:
            want = f"{count} finite numbers with spaces between such as 0 0 0.1"
        hint = ""
        if "${" in text or "$(" in text:
            hint = f" {expand_xacro()}"
        elif "," in text:
            hint = " Write decimals with a point."
        raise self.error(f"has {attribute} {shown(text)}, expected {want}.{hint}")

    def number(self, attribute: str, default: str | None = None, infinite: bool = False) -> float:
        return float(self.words(attribute, 1, default, infinite)[0])


@dataclass(frozen=True)
class Remarks:
    """What looks odd: one sentence for each kind of oddity, however often it occurs."""

    first: dict[str, str] = field(default_factory=dict)
    lines: dict[str, list[int]] = field(default_factory=dict)

    def add(self, kind: str, node: Node, sentence: str) -> None:
        """Remark on something; of a kind that is there already, only the line is kept."""
        self.first.setdefault(kind, f"{node.what} {sentence}")
        lines = self.lines.setdefault(kind, [])
        if node.line not in lines[-1:]:
            lines.append(node.line)

    def sentences(self) -> tuple[str, ...]:
        return tuple(s + _likewise(self.lines[kind][1:]) for kind, s in self.first.items())


def _likewise(lines: list[int]) -> str:
    if not lines:
        return ""
    listed = ", ".join(str(line) for line in lines[:5])
    more = f" and {len(lines) - 5} more" if len(lines) > 5 else ""
    return f" Likewise on line{'s' if len(lines) > 1 else ''} {listed}{more}."
