"""Names that look like slips of others, and how a message asks whether one of these is meant."""

from difflib import SequenceMatcher, get_close_matches
from typing import AbstractSet, Collection, Iterable, List, Optional, Tuple

from rosoclingo.oclingo.program.survey import OWN
from rosoclingo.oclingo.progression.terms import Signature

_ALIKE = 0.8  # so alike, of 1, are names of which one may be a slip of the other
_NEAR = 0.6  # and so alike those of which one may be meant where nothing is true
_SHORTEST = 4  # names with fewer letters are alike by chance
_MANY = 6  # values that a message lists


# ---- predicates -----------------------------------------------------------------------------------------------------


def likely(signature: Signature, known: Iterable[Signature]) -> Optional[Signature]:
    """Return the one of ``known`` that ``signature`` may have been meant to be, None where nothing is like it."""
    found: List[Tuple[float, int, Signature]] = []
    for one in sorted(known):
        near = likeness(signature.name, one.name)
        if (
            one != signature
            and not one.name.startswith(OWN)
            and near >= (_NEAR if one.arity == signature.arity else _ALIKE)
        ):
            found.append((near, -abs(one.arity - signature.arity), one))
    return max(found, key=lambda told: told[:2])[2] if found else None


def likely_external(signature: Signature, externals: AbstractSet[Signature]) -> str:
    """Return the mend for a fact of a predicate that is not declared: the external that is meant, or a new one."""
    return asked(likely(signature, externals)) or f"write #external {signature}."


def slip_of(signature: Signature, used: Collection[Signature], shows: bool) -> Optional[Signature]:
    """Return what of the ``used`` predicates a predicate that is not used may stand for."""
    same = [one for one in used if one.name == signature.name and one.positive == signature.positive]
    if same and shows:
        return min(same, key=lambda one: abs(one.arity - signature.arity))
    alike = [one for one in sorted(used) if one.arity == signature.arity and _alike(one.name, signature.name)]
    return max(alike, key=lambda one: likeness(one.name, signature.name), default=None)


def _alike(one: str, other: str) -> bool:
    short = min(len(one), len(other)) < _SHORTEST or one.startswith("_") != other.startswith("_")
    return one != other and not short and likeness(one, other) >= _ALIKE


def likeness(one: str, other: str) -> float:
    """Return how alike two names are, from 0 to 1."""
    return SequenceMatcher(None, one, other).ratio()


# ---- words: one letter -------------------------------------------------------------------------------------------


def is_slip(text: str, other: str, shortest: int = _SHORTEST) -> bool:
    """Tell whether a word is another one but for one letter: left out, doubled, added, changed or exchanged.

    What names of a row differ by is no slip: a digit, an ``s`` at the end, the last letter, a letter by itself.
    """
    if text == other or min(len(text), len(other)) < shortest or abs(len(text) - len(other)) > 1:
        return False
    start = next((n for n, pair in enumerate(zip(text, other)) if pair[0] != pair[1]), min(len(text), len(other)))
    if len(text) != len(other):
        return _is_added(min(text, other, key=len), max(text, other, key=len), start)
    pair, its = text[start : start + 2], other[start : start + 2]
    if pair == its[::-1] and text[start + 2 :] == other[start + 2 :]:
        return not set(pair) & _OF_ROWS
    within = start < len(text) - 1 and len(text) > shortest and text[start + 1 :] == other[start + 1 :]
    return within and not {text[start], other[start]} & _OF_ROWS and not _is_alone(text, start)


def _is_added(shorter: str, longer: str, place: int) -> bool:
    """Tell whether the longer word has one letter more, at the place, which is none that tells names of a row apart."""
    plural = place == len(shorter) and longer.endswith("s")
    of_rows = longer[place] != "_" and longer[place] in _OF_ROWS
    return longer[place + 1 :] == shorter[place:] and not of_rows and not plural


def _is_alone(text: str, place: int) -> bool:
    """Tell whether a letter stands by itself in a name of several words."""
    return (place == 0 or text[place - 1] == "_") and text[place + 1] == "_"


_OF_ROWS = frozenset("0123456789_'")  # by which the names of a row differ

# ---- words ----------------------------------------------------------------------------------------------------------


def asked(meant: object) -> str:
    """Return the question whether ``meant`` is meant, "" where it is None."""
    return "" if meant is None else f"is {meant} meant?"


def likely_word(text: str, known: Iterable[str]) -> str:
    """Return the question whether the one of ``known`` is meant that is most like ``text``, "" where none is."""
    return asked(next(iter(get_close_matches(text, sorted(known), 1)), None))


def likely_value(text: str, known: Collection[str]) -> str:
    """Return which of the values ``known`` may be meant by ``text``, or which there are."""
    shown = sorted(known)[:_MANY]
    return likely_word(text, {_filled(one, text) for one in known}) or "it may be {}{}".format(
        ", ".join(shown), " ..." if len(known) > _MANY else ""
    )


def _filled(value: str, text: str) -> str:
    """Return a value ``at(_)`` of open arguments with those of the text, ``att(sink)``, if it has as many of them."""
    name, bracket, rest = value.partition("(")
    _, _, own = text.partition("(")
    is_open = set(rest[:-1].split(",")) == {"_"} and rest.count(",") == own.count(",")
    return f"{name}{bracket}{own}" if is_open and own else value
