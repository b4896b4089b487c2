"""Suggestions for a term that matches no rule, from the names and values of the rules."""

from difflib import SequenceMatcher, get_close_matches
from itertools import islice
from typing import FrozenSet, Iterable, Iterator, Optional, Sequence, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.nodes import Node

_ALIKE = 0.6  # minimum similarity, from 0 to 1, of names that can be confused
_LONGEST, _COMPARED = 100, 1000  # maximum number of compared letters of a text, and of compared values
_SHOWN = 6  # maximum number of values or forms in a message

Misfit = Tuple[clingo.Symbol, FrozenSet[clingo.Symbol]]
"""A value of an atom that a rule excludes, and the values that the rule allows in its place."""


def bindings(term: Node, symbol: clingo.Symbol) -> Iterator[Tuple[str, clingo.Symbol]]:
    """Yield the variables of a term, each with its value in ``symbol``."""
    if term.ast_type == ASTType.Variable:
        yield term.name, symbol
    elif term.ast_type == ASTType.Function and symbol.type is clingo.SymbolType.Function:
        for one, value in zip(term.arguments, symbol.arguments):
            yield from bindings(one, value)


def correct(term: clingo.Symbol, misfits: Sequence[Misfit]) -> Optional[clingo.Symbol]:
    """Return a term with each misfit replaced by the most similar known value; None if no value is similar."""
    for value, known in misfits:
        if term == value:
            words = {_word(one): one for one in islice(sorted(known), _COMPARED)}
            return next((words[one] for one in get_close_matches(_word(value), words, 1)), None)
    if term.type is not clingo.SymbolType.Function:
        return term
    arguments = [correct(one, misfits) for one in term.arguments]
    return None if None in arguments else clingo.Function(term.name, arguments, term.positive)  # type: ignore[arg-type]


def _word(value: clingo.Symbol) -> str:
    return (value.string if value.type is clingo.SymbolType.String else str(value)).casefold()[:_LONGEST]


def fit_to_form(form: Node, term: clingo.Symbol) -> Optional[clingo.Symbol]:
    """Return the name and constants of a rule's ``form`` with the arguments of ``term``; None if they differ a lot."""
    if form.ast_type == ASTType.Variable:
        return term
    if form.ast_type == ASTType.SymbolicTerm:
        return form.symbol if likeness(_word(form.symbol), _word(term)) >= _ALIKE else None
    if form.ast_type != ASTType.Function or term.type is not clingo.SymbolType.Function:
        return None
    if len(form.arguments) != len(term.arguments) or likeness(form.name, term.name) < _ALIKE:
        return None
    arguments = [fit_to_form(one, value) for one, value in zip(form.arguments, term.arguments)]
    return None if None in arguments else clingo.Function(form.name, arguments)  # type: ignore[arg-type]


def likeness(one: str, other: str) -> float:
    """Return the similarity of two texts, from 0 to 1; anagrams are equal, and case is ignored."""
    one, other = one.casefold()[:_LONGEST], other.casefold()[:_LONGEST]
    return 1.0 if sorted(one) == sorted(other) else SequenceMatcher(None, one, other).ratio()


def join_texts(texts: Iterable[str], in_order: bool = False) -> str:
    """Return the first texts without duplicates, joined by commas; sorted unless they are ``in_order``."""
    found = list(dict.fromkeys(texts if in_order else sorted(texts)))
    return ", ".join(found[:_SHOWN]) + (" ..." if len(found) > _SHOWN else "")
