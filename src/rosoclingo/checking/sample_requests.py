"""Requests that a program may get, made of what its rules ask for and of the names in its facts."""

from collections import Counter
from itertools import islice, product
from typing import Iterator, List, Sequence

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.errors import ProgressionError
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import parse_atom

#: So many names, those that facts mention most, and so many requests of a kind.
NAMES, MOST = 20, 200

IDENTIFIER = "1"
"""What the last argument of a request may be, which tells it from others."""


def sample_requests(program: ReactiveProgram) -> List[Iterator[str]]:
    """Return, for each kind of request that the program's rules ask for, some that are likely to make sense."""
    kinds = {
        _shape(one.term.arguments[0]): one.term.arguments[0]
        for part in program.parts
        for statement, one in part.atoms
        if (one.signature.name, one.signature.arity) == ("_request", 2) and statement.ast_type == ASTType.Rule
    }
    names = names_in_facts(program)
    return [_filled(kind, names) for text, kind in sorted(kinds.items()) if _is_goal(kind)]


def _is_goal(term: Node) -> bool:
    return bool(term.ast_type == ASTType.Function and term.name not in ("", "cancel") and term.arguments)


def _shape(term: Node) -> str:
    """Return a term's text, whatever its variables are called."""
    if not _is_goal(term):
        return str(term)
    arguments = ("_" if one.ast_type == ASTType.Variable else str(one) for one in term.arguments)
    return f"{term.name}({','.join(arguments)})"


def _filled(kind: Node, names: List[str]) -> Iterator[str]:
    """Yield requests of a kind, in which each name stands once, those first whose names are mentioned most."""
    arguments = list(kind.arguments)
    choices = [names if one.ast_type == ASTType.Variable else [str(one)] for one in arguments]
    if len(arguments) > 1 and arguments[-1].ast_type == ASTType.Variable:
        choices[-1] = [IDENTIFIER, *names]
    return (f"{kind.name}({','.join(words)})" for words in chosen(choices))


def chosen(choices: Sequence[Sequence[str]]) -> Iterator[List[str]]:
    """Yield, :data:`MOST` times at the most, a word of each choice, none twice, from those that come first on."""
    places = sorted(product(*(range(len(choice)) for choice in choices)), key=sum)
    every = ([choice[place] for choice, place in zip(choices, some)] for some in places)
    return islice((words for words in every if len(set(words)) == len(words)), MOST)


def names_in_facts(program: ReactiveProgram) -> List[str]:
    """Return the names that the program's facts mention most often, and of these the first ones."""
    found: Counter = Counter()
    for part in program.parts:
        for statement in part.statements if part.name == "base" else ():
            if statement.ast_type == ASTType.Rule and not statement.body:
                try:
                    fact = parse_atom(str(statement.head))
                except ProgressionError:  # an interval, a pool: not one fact
                    continue
                if fact.name.startswith("_"):  # for people, or of no concern to requests
                    continue
                found.update(str(one) for one in fact.arguments if one.type is clingo.SymbolType.Function)
    return [name for name, _ in found.most_common(NAMES)]
