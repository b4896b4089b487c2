"""Replacement of statements in a text that preserves comments, layout and line numbers."""

from difflib import SequenceMatcher
from typing import List, Mapping, Sequence

from rosoclingo.oclingo.gringo3.dialect import SourceFile
from rosoclingo.oclingo.gringo3.lexer import SourceToken, tokens

_MOST = 100_000  # maximum number of compared token pairs; larger statements lose their layout


def rewritten(source: SourceFile, texts: Mapping[int, str]) -> str:
    """Return a file with new ``texts``, without newlines and comments, for some of its statements, by their numbers.

    Unchanged tokens keep their layout and comments; each statement keeps its number of lines.
    """
    pieces: List[str] = []
    offset = 0
    for number, new in sorted(texts.items()):
        old = source.statement(number)
        pieces += [source.text[offset : old[0].start], _merged(source.text, old, new)]
        offset = old[-1].end
    return "".join([*pieces, source.text[offset:]])


def _merged(old_text: str, old: Sequence[SourceToken], text: str) -> str:
    """Return the new ``text`` of a statement with the layout of the ``old`` tokens."""
    new = tokens(text)[:-1]
    words, new_words = [one.text for one in old], [one.text for one in new]
    small = len(words) * len(new_words) < _MOST
    whole = [("replace", 0, len(words), 0, len(new_words))]
    matcher = SequenceMatcher(lambda word: word in ",;:", words, new_words, autojunk=False)
    found = ""
    for kind, first, after, start, end in matcher.get_opcodes() if small else whole:
        gap, own = _gap(old_text, old, first), _gap(text, new, start)
        lead = gap if kind != "insert" and {"\n", "%"} & set(gap) else "" if kind == "delete" else own
        if kind == "equal":
            kept = (_gap(old_text, old, n) + old[n].text for n in range(first + 1, after))
            found += lead + old[first].text + "".join(kept)
        else:
            dropped = old_text[old[first].start : old[after - 1].end] if after > first else ""
            added = text[new[start].start : new[end - 1].end] if end > start else ""
            found += lead + added + "\n" * dropped.count("\n")
    return found


def _gap(text: str, row: Sequence[SourceToken], index: int) -> str:
    """Return the text between a token and its predecessor."""
    return text[row[index - 1].end : row[index].start] if 0 < index < len(row) else ""
