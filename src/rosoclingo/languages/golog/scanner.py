"""The words of a control program, each with its place."""

import re
from typing import List, NamedTuple

from rosoclingo.oclingo.errors import Fault

RESERVED = frozenset(
    [
        "proc",
        "include",
        "if",
        "else",
        "while",
        "pick",
        "choose",
        "or",
        "any",
        "order",
        "and",
        "star",
        "interleave",
        "with",
        "prefer",
        "over",
        "search",
        "alone",
        "try",
        "retry",
        "do",
        "test",
        "await",
        "achieve",
        "interrupts",
        "when",
        "until",
        "not",
        "some",
        "all",
        "true",
        "false",
        "in",
    ]
)
"""Names that no action, fluent or procedure can have."""

_WORD = re.compile(
    r"""(?P<space>\s+|%\*.*?\*%|%[^\n]*)|(?P<number>\d+)|(?P<variable>[A-Z][A-Za-z0-9_]*|_(?![A-Za-z0-9_]))|(?P<name>[a-z][A-Za-z0-9_]*)
    |(?P<string>"(?:[^"\\\n]|\\.)*")|(?P<sign>\.\.|->|!=|<=|>=|=(?!=)|[-{}(),;:<>+*/\\])
    |(?P<quoted>'[^'\n]*')""",
    re.VERBOSE | re.DOTALL,
)


GREATEST = 2**31 - 1
"""The greatest number that clingo knows; of greater ones it would take what is left of some of their bits."""


class GologError(Exception):
    """A control program is not as it should be; ``fault`` says where and what to write instead."""

    def __init__(self, fault: Fault) -> None:
        self.fault = fault
        super().__init__(str(fault))


class Token(NamedTuple):
    """One word: its kind (name, variable, number, string, sign, word if it is reserved, end), text, place from 1."""

    kind: str
    text: str
    line: int
    column: int

    def __str__(self) -> str:
        return "the end of the file" if self.kind == "end" else f"'{self.text}'"


def scan(text: str, name: str, faults: List[Fault]) -> List[Token]:
    """Return the words of a text, the last of which is its end; what is none is added to ``faults`` and left out."""
    tokens, position = [], 0  # type: List[Token], int
    line, begin = 1, 0  # where the line begins
    while position < len(text):
        match = _WORD.match(text, position)
        if match is None:
            faults.append(Fault(name, line, position - begin + 1, *_unknown(text, position)))
            position = _behind(text, position)
            continue
        kind, word = str(match.lastgroup), match.group()
        if kind == "quoted":
            faults.append(Fault(name, line, position - begin + 1, f"{word} is no string", f'write "{word[1:-1]}"'))
            kind = "string"
        if kind != "space":
            kind = "word" if kind == "name" and word in RESERVED else kind
            if kind == "number" and _is_great(word):
                told = f"the number {word} is too great", f"have at most {GREATEST}, or write it as a string"
                faults.append(Fault(name, line, position - begin + 1, *told))
            tokens.append(Token(kind, word, line, position - begin + 1))
        if "\n" in word:
            line, begin = line + word.count("\n"), position + word.rindex("\n") + 1
        position = match.end()
    return [*tokens, Token("end", "", line, position - begin + 1)]


def _is_great(number: str) -> bool:
    digits = number.lstrip("0") or "0"
    return len(digits) > len(str(GREATEST)) or int(digits) > GREATEST


def _behind(text: str, position: int) -> int:
    """Return where to go on after what is no word: behind an open string's line, or behind the character."""
    end = text.find("\n", position)
    return position + 1 if text[position] != '"' else (len(text) if end < 0 else end)


_INSTEAD = {
    "?": ("'?'", "write test CONDITION;"),
    "|": ("'|'", "write or, or interleave {...} with {...}"),
    "&": ("'&'", "write and"),
    "!": ("'!'", "write not, or !="),
    "=": ("'=='", "write ="),
}


def _unknown(text: str, position: int) -> List[str]:
    """Return what is wrong with a character, and the mend."""
    character = text[position]
    if character == '"':
        return ["the string has no end on its line", 'write " behind it']
    word, mend = _INSTEAD.get(character, (repr(character), "comments begin with %"))
    return [f"{word} is no word of the language", mend]
