"""Sample requests for a program, formed from its rules for requests and the names in its facts."""

from collections import Counter
from itertools import islice, product
from typing import Iterator, List, Sequence

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.errors import ProgressionError
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import parse_atom

#: Greatest numbers of names, which facts mention most, and of requests of each kind.
NAMES, MOST = 20, 200

IDENTIFIER = "1"
"""The preferred last argument of a request, which identifies it."""


def sample_requests(program: ReactiveProgram) -> List[Iterator[str]]:
    """Return likely requests for each kind of request in the program's rules."""
    kinds = {
        _shape(one.term.arguments[0]): one.term.arguments[0]
        for part in program.parts
        for statement, one in part.atoms
        if (one.signature.name, one.signature.arity) == ("_request", 2) and statement.ast_type == ASTType.Rule
    }
    names = names_in_facts(program)
    return [_requests(kind, names) for text, kind in sorted(kinds.items()) if _is_goal(kind)]


def _is_goal(term: Node) -> bool:
    return bool(term.ast_type == ASTType.Function and term.name not in ("", "cancel") and term.arguments)


def _shape(term: Node) -> str:
    """Return the text of a term with anonymous variables."""
    if not _is_goal(term):
        return str(term)
    arguments = ("_" if one.ast_type == ASTType.Variable else str(one) for one in term.arguments)
    return f"{term.name}({','.join(arguments)})"


def _requests(kind: Node, names: List[str]) -> Iterator[str]:
    """Yield requests of a kind with different names in all arguments, the most frequent names first."""
    arguments = list(kind.arguments)
    choices = [names if one.ast_type == ASTType.Variable else [str(one)] for one in arguments]
    if len(arguments) > 1 and arguments[-1].ast_type == ASTType.Variable:
        choices[-1] = [IDENTIFIER, *names]
    return (f"{kind.name}({','.join(words)})" for words in combine(choices))


def combine(choices: Sequence[Sequence[str]]) -> Iterator[List[str]]:
    """Yield rows of different words, one of each choice, the first words first; at most :data:`MOST` rows."""
    places = sorted(product(*(range(len(choice)) for choice in choices)), key=sum)
    rows = ([choice[place] for choice, place in zip(choices, some)] for some in places)
    return islice((words for words in rows if len(set(words)) == len(words)), MOST)


def names_in_facts(program: ReactiveProgram) -> List[str]:
    """Return the names that the program's facts mention most often."""
    found: Counter = Counter()
    for part in program.parts:
        for statement in part.statements if part.name == "base" else ():
            if statement.ast_type == ASTType.Rule and not statement.body:
                try:
                    fact = parse_atom(str(statement.head))
                except ProgressionError:  # an interval or a pool, which stands for several facts
                    continue
                if fact.name.startswith("_"):  # keywords such as _says/2, whose names are not arguments of requests
                    continue
                found.update(str(one) for one in fact.arguments if one.type is clingo.SymbolType.Function)
    return [name for name, _ in found.most_common(NAMES)]
