"""The one way from names of a description to text of a program: identifiers, and words in comments.

A description is untrusted: nothing of it reaches generated text but through `Names` and `words`.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

LONGEST = 40
"""Characters of an identifier; MATLAB takes 63, with what is put behind a name."""

WORDS = """
# C, C++, and what headers make macros of
alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t
char32_t char8_t class co_await co_return co_yield compl complex concept const const_cast
consteval constexpr constinit continue decltype default delete do double dynamic_cast else
enum explicit export extern false float for friend goto if imaginary inline int long mutable
namespace new noexcept not not_eq nullptr operator or or_eq private protected public
register reinterpret_cast requires restrict return short signed sizeof static static_assert
static_cast struct switch template this thread_local throw true try typedef typeid typename
typeof union unsigned using virtual void volatile wchar_t while xor xor_eq linux unix near
far huge errno main NULL EOF Eigen std
# Java
abstract assert boolean byte extends final finally implements import instanceof interface
native null package permits record sealed strictfp super synchronized throws transient var
yield String Object Math Override
# JavaScript
arguments async await debugger eval function in let of with undefined NaN Infinity Array
Number Symbol constructor prototype __proto__ Float64Array
# Python
None True False def del elif except from global is lambda nonlocal pass raise match type np
numpy self print
# MATLAB and Octave
end elseif otherwise parfor persistent spmd classdef methods properties events enumeration
endfunction endif endfor endwhile endswitch until unwind_protect pi eps inf nan i j ans
varargin varargout nargin nargout error
# Wolfram: its own symbols of one letter
C D E I K N O
# files that packages have
selftest SelfTest vectors fmi2 fmi3 fmu fmu_model fmu_motion
# what generated functions call their own
q qdot qddot tau v params parameters work cos sin M Cqdot g Minv T P J Js Y c dg_dq dtau_dq
dtau_dqdot dqddot_dq dqddot_dqdot Cv a pose poses step
"""

RESERVED = frozenset(
    word for line in WORDS.splitlines() if not line.startswith("#") for word in line.split()
)

GREEK = re.compile(r"GREEK (?:SMALL|CAPITAL) LETTER (?:FINAL )?([A-Z]+)")


class Names:
    """Identifiers for names of any alphabet, each given once.

    An identifier is of ASCII letters, digits and single underscores, begins with a letter, is no
    word of any language that code is written in, and differs from the others without regard to
    case, and to underscores, which Wolfram's language lacks.
    """

    def __init__(self, taken: Iterable[str] = ()):
        self._taken = {_folded(name) for name in taken}

    def of(self, name: str, otherwise: str = "x") -> str:
        """An identifier like the name.

        Args:
            otherwise: what a name without a letter or digit becomes, and begins with where it
                begins with a digit
        """
        plain = identifier(name, otherwise)
        found, k = plain, 1
        while _folded(found) in self._taken:
            k += 1
            found = f"{plain}_{k}"
        self._taken.add(_folded(found))
        return found


def identifier(name: str, otherwise: str = "x") -> str:
    found = re.sub(r"_+", "_", "".join(map(_letters, name))).strip("_")[:LONGEST].strip("_")
    if not found or found[0].isdigit():
        found = f"{otherwise}_{found}".rstrip("_")
    return f"{found}_" if found in RESERVED else found


def _letters(character: str) -> str:
    """ASCII for a character: itself, its base letter, a Greek letter's name, its number."""
    if character.isascii():
        return character if character.isalnum() else "_"
    base = unicodedata.normalize("NFKD", character)
    base = "".join(c for c in base if c.isascii() and c.isalnum())
    if base:
        return base
    title = unicodedata.name(character, "")
    greek = GREEK.fullmatch(title)
    if greek:
        word = greek[1].lower().replace("lamda", "lambda")
        return word.capitalize() if "CAPITAL" in title else word
    return f"u{ord(character):04x}" if character.isalnum() else "_"


def _folded(name: str) -> str:
    return name.replace("_", "").lower()


def pascal(name: str) -> str:
    """planar_2r -> Planar2r, the form of types; digits stay where they are."""
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


def camel(name: str) -> str:
    """inverse_dynamics -> inverseDynamics."""
    whole = pascal(name)
    return whole[:1].lower() + whole[1:]


def words(text: str) -> str:
    """A name for comments and documents of any language: what could end one is an underscore."""
    plain = unicodedata.normalize("NFKD", text)
    kept = "".join(c for c in plain if c.isascii() or not unicodedata.combining(c))
    return re.sub(r"[^A-Za-z0-9 _.,:+()-]", "_", kept)[:200] or "_"
