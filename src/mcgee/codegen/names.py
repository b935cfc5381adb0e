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
# what generated functions call their own
q qdot qddot tau v params parameters work cos sin M Cqdot g Minv T P J Js Y c dg_dq dtau_dq
dtau_dqdot dqddot_dq dqddot_dqdot Cv a pose poses step
"""

RESERVED = frozenset(
    word for line in WORDS.splitlines() if not line.startswith("#") for word in line.split()
)

MACROS = re.compile(r"NAN|INFINITY|HUGE_VALL?F?|(M|DBL|FLT|LDBL|FE|FP|U?INT\w*)_[A-Z]\w*")
"""Of C's headers."""

HIDDEN = """
abc aifc annotationlib antigravity argparse array assert ast asynchat asyncio asyncore atexit
audioop base64 bdb binascii bisect builtins bz2 calendar cg_sfun cgi cgitb chunk cmakelists
cmath cmd code codecs codeop collections colorsys compileall complex compression concurrent
configparser contextlib contextvars copy copyreg crypt csv ctype ctypes curses dataclasses
datetime dbm decimal difflib dis distutils doctest email encodings ensurepip enum errno
faulthandler fcntl fenv filecmp fileinput float fmi2 fmi2functions fmi2functiontypes
fmi2typesplatform fmi3 fmi3functions fmi3functiontypes fmi3platformtypes fmu fmumodel fmumotion
fnmatch fractions ftplib functools gc genericpath getopt getpass gettext glob graphlib grp gzip
hashlib heapq hmac html http idlelib imaplib imghdr imp importlib inspect inttypes io ipaddress
iso646 itertools json keyword lib2to3 license limits linecache locale logging lzma mailbox
mailcap marshal math matrix mex mimetypes mmap modulefinder msilib msvcrt multiprocessing netrc
nis nntplib nt ntpath nturl2path numbers numpy opcode operator optparse os ossaudiodev pathlib
pdb pickle pickletools pipes pkgutil platform plistlib poplib posix posixpath pprint profile
pstats pty pwd pyclbr pydoc pydocdata pyexpat queue quopri random re readline readme reprlib
resource rlcompleter rtwtypes runpy sched secrets select selectors selftest setjmp setup shelve
shlex shutil signal simstruc simulink site smtpd smtplib sndhdr socket socketserver spwd sqlite3
ssl stat statistics stdalign stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn
string stringprep struct subprocess sunau symtable sys sysconfig syslog tabnanny tarfile
telnetlib tempfile termios textwrap tgmath this threading threads time timeit tkinter tmwtypes
token tokenize tomllib trace traceback tracemalloc tty turtle turtledemo types typing uchar
unicodedata unistd unittest urllib uu uuid vectors venv verified warnings wave wchar wctype
weakref webbrowser winreg winsound wsgiref xdrlib xml xmlrpc zipapp zipfile zipimport zlib
zoneinfo
"""
"""Modules of Python, headers of C and files of packages, which a file of that name would hide."""

FILES = frozenset(HIDDEN.split())

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
            found = f"{plain.rstrip('_')}_{k}"
        self._taken.add(_folded(found))
        return found


def identifier(name: str, otherwise: str = "x") -> str:
    found = re.sub(r"_+", "_", "".join(map(_letters, name))).strip("_")[:LONGEST].strip("_")
    if not found or found[0].isdigit():
        found = f"{otherwise}_{found}".rstrip("_")
    return f"{found}_" if found in RESERVED or MACROS.fullmatch(found) else found


def stem(name: str) -> str:
    """What a robot's files, types and functions begin with."""
    found = identifier(name, "arm").rstrip("_")
    is_taken = found in RESERVED or MACROS.fullmatch(found) or _folded(found) in FILES
    return f"{found}_arm" if is_taken else found


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
