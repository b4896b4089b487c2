"""Names that look like slips of others, and how a message asks whether one of these is meant."""

from difflib import SequenceMatcher, get_close_matches
from typing import AbstractSet, Collection, Iterable, List, Optional, Tuple

from rosoclingo.oclingo.program.lint.survey import OWN
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
        near = _likeness(signature.name, one.name)
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
    return max(alike, key=lambda one: _likeness(one.name, signature.name), default=None)


def _alike(one: str, other: str) -> bool:
    short = min(len(one), len(other)) < _SHORTEST or one.startswith("_") != other.startswith("_")
    return one != other and not short and _likeness(one, other) >= _ALIKE


def _likeness(one: str, other: str) -> float:
    return SequenceMatcher(None, one, other).ratio()


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
    return likely_word(text, known) or "it may be {}{}".format(", ".join(shown), " ..." if len(known) > _MANY else "")
