"""Parse atoms in texts of topics; the result is None for any other text."""

import functools
from typing import Callable, Optional, TypeVar

from clingo import Symbol, SymbolType

from rosoclingo.oclingo import ProgressionError, parse_atom
from rosoclingo.reasoning.keywords import RUN, Action, KeywordError, Return, action_of, is_keyword, return_of

T = TypeVar("T")


#: Limit of characters of a cached atom.
SHORT = 1000


def atom_in(text: str) -> Optional[Symbol]:
    """Return the ground atom in a text."""
    return _cached(text) if len(text) <= SHORT else _parsed(text)


def _parsed(text: str) -> Optional[Symbol]:
    try:
        return parse_atom(text)
    except ProgressionError:
        return None


_cached = functools.lru_cache(maxsize=10000)(_parsed)


def action_in(text: str) -> Optional[Action]:
    """Return the action of ``_action_lib(A,P,C)``."""
    return _read(text, action_of)


def return_in(text: str) -> Optional[Return]:
    """Return the return of ``_return(A,V,C)``."""
    return _read(text, return_of)


def run_in(text: str) -> Optional[str]:
    """Return the id of the run that the core announces by ``_run("ID")``."""
    atom = atom_in(text)
    if atom is None or not is_keyword(atom, RUN) or len(atom.arguments) != 1:
        return None
    return atom.arguments[0].string if atom.arguments[0].type is SymbolType.String else None


def _read(text: str, read: Callable[[Symbol], T]) -> Optional[T]:
    atom = atom_in(text)
    try:
        return None if atom is None else read(atom)
    except KeywordError:
        return None
