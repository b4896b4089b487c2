"""Detection of misspelt names, and the wording of suggestions in messages."""

from difflib import SequenceMatcher, get_close_matches
from typing import AbstractSet, Collection, Iterable, List, Optional, Tuple

from rosoclingo.oclingo.program.survey import OWN
from rosoclingo.oclingo.progression.terms import Signature

_ALIKE = 0.8  # least similarity of a name and its misspelling; equal names have 1
_NEAR = 0.6  # least similarity of a suggestion for a predicate that nothing defines
_SHORTEST = 4  # names with fewer letters are similar by chance
_LISTED = 6  # maximum number of values in a message


# ---- predicates -----------------------------------------------------------------------------------------------------


def most_similar(signature: Signature, known: Iterable[Signature]) -> Optional[Signature]:
    """Return the most similar predicate in ``known``, None if none is similar enough."""
    found: List[Tuple[float, int, Signature]] = []
    for one in sorted(known):
        near = likeness(signature.name, one.name)
        if (
            one != signature
            and not one.name.startswith(OWN)
            and near >= (_NEAR if one.arity == signature.arity else _ALIKE)
        ):
            found.append((near, -abs(one.arity - signature.arity), one))
    return max(found, key=lambda entry: entry[:2])[2] if found else None


def likely_external(signature: Signature, externals: AbstractSet[Signature]) -> str:
    """Return a fix for a fact of an undeclared predicate: a similar external, or a new declaration."""
    return did_you_mean(most_similar(signature, externals)) or f"write #external {signature}."


def likely_spelling(signature: Signature, used: Collection[Signature], shows: bool) -> Optional[Signature]:
    """Return the used predicate that an unused one probably misspells, None if none is similar enough."""
    same = [one for one in used if one.name == signature.name and one.positive == signature.positive]
    if same and shows:
        return min(same, key=lambda one: abs(one.arity - signature.arity))
    alike = [one for one in sorted(used) if one.arity == signature.arity and _alike(one.name, signature.name)]
    return max(alike, key=lambda one: likeness(one.name, signature.name), default=None)


def _alike(one: str, other: str) -> bool:
    short = min(len(one), len(other)) < _SHORTEST or one.startswith("_") != other.startswith("_")
    return one != other and not short and likeness(one, other) >= _ALIKE


def likeness(one: str, other: str) -> float:
    """Return the similarity of two names, from 0 to 1."""
    return SequenceMatcher(None, one, other).ratio()


# ---- slips of one letter -----------------------------------------------------------------------------------------


def is_misspelling(text: str, other: str, shortest: int = _SHORTEST) -> bool:
    """Return whether two words differ by one letter that is omitted, doubled, added, changed or swapped.

    Differences between names of a series do not count: a digit, a final ``s``, the last letter, a one-letter word.
    """
    if text == other or min(len(text), len(other)) < shortest or abs(len(text) - len(other)) > 1:
        return False
    start = next((n for n, pair in enumerate(zip(text, other)) if pair[0] != pair[1]), min(len(text), len(other)))
    if len(text) != len(other):
        return _is_added(min(text, other, key=len), max(text, other, key=len), start)
    pair, its = text[start : start + 2], other[start : start + 2]
    if pair == its[::-1] and text[start + 2 :] == other[start + 2 :]:
        return not set(pair) & _SERIES_MARKS
    within = start < len(text) - 1 and len(text) > shortest and text[start + 1 :] == other[start + 1 :]
    is_word = text[start + 1 : start + 2] == "_" and (start == 0 or text[start - 1] == "_")  # one of several words
    return within and not {text[start], other[start]} & _SERIES_MARKS and not is_word


def _is_added(shorter: str, longer: str, place: int) -> bool:
    """Return whether the longer word has one more letter at the place, which does not mark a name of a series."""
    plural = place == len(shorter) and longer.endswith("s")
    is_mark = longer[place] != "_" and longer[place] in _SERIES_MARKS
    return longer[place + 1 :] == shorter[place:] and not is_mark and not plural


_SERIES_MARKS = frozenset("0123456789_'")  # distinguish the names of a series

# ---- words ----------------------------------------------------------------------------------------------------------


def did_you_mean(name: object) -> str:
    """Return the question whether the user means ``name``, "" for None."""
    return "" if name is None else f"did you mean {name}?"


def likely_word(text: str, known: Iterable[str]) -> str:
    """Return a question that suggests the word in ``known`` most similar to ``text``, "" if none is similar."""
    return did_you_mean(next(iter(get_close_matches(text, sorted(known), 1)), None))


def likely_value(text: str, known: Collection[str]) -> str:
    """Return the suggestion of a similar value in ``known``; if there is none, the first of all values."""
    shown = sorted(known)[:_LISTED]
    return likely_word(text, {_filled(one, text) for one in known}) or "known: {}{}".format(
        ", ".join(shown), " ..." if len(known) > _LISTED else ""
    )


def _filled(value: str, text: str) -> str:
    """Return ``at(sink)`` for a value ``at(_)`` and a text ``att(sink)`` with the same number of arguments."""
    name, bracket, rest = value.partition("(")
    _, _, own = text.partition("(")
    is_open = set(rest[:-1].split(",")) == {"_"} and rest.count(",") == own.count(",")
    return f"{name}{bracket}{own}" if is_open and own else value
