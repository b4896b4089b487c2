"""Sample requests for a program, formed from its rules for requests and the names in its facts."""

from collections import Counter
from itertools import islice, product
from typing import Dict, Iterable, Iterator, List, Sequence, Tuple, TypeVar

import clingo
from clingo.ast import ASTType

from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.oclingo.errors import ProgressionError
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Occurrence
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import Signature, parse_atom, parse_term
from rosoclingo.planning.explaining.atom_patterns import ANY, Patterns, is_variable, names_of, patterns_of, substitute

#: Greatest numbers of names, which facts mention most, of requests of each kind, and of instances of a pattern.
NAMES, MOST, MOST_INSTANCES = 20, 200, 1000

IDENTIFIER = "1"
"""The preferred last argument of a request, which identifies it."""

_REQUEST = Signature("_request", 2)

T = TypeVar("T")

Use = Tuple[Occurrence, Patterns]
"""An atom in a rule, and the patterns of the terms wanted from it."""


def sample_requests(program: ReactiveProgram) -> List[Iterator[str]]:
    """Return likely requests for each kind of request in the program's rules."""
    kinds: Dict[str, List[Use]] = {}
    for place in program.survey.using.get(_REQUEST, ()):
        goal = place.arguments[0]
        if place.statement.ast_type == ASTType.Rule and _is_goal(goal):
            kinds.setdefault(_shape(goal), []).append((place, patterns_of(goal, dict(program.values))))
    names = [*map(parse_term, names_in_facts(program))]
    return [_requests(likely_patterns(program, uses), names) for _, uses in sorted(kinds.items())]


def _is_goal(term: Node) -> bool:
    return bool(term.ast_type == ASTType.Function and term.name not in ("", "cancel") and term.arguments)


def _shape(goal: Node) -> str:
    """Return the text of a goal with anonymous variables."""
    arguments = ("_" if one.ast_type == ASTType.Variable else str(one) for one in goal.arguments)
    return f"{goal.name}({','.join(arguments)})"


def _requests(patterns: Sequence[clingo.Symbol], names: Sequence[clingo.Symbol]) -> Iterator[str]:
    """Yield instances of the patterns of goals with different arguments, the most frequent names first."""
    unbound = len(names_of(patterns[0])) if patterns else 0
    identified = any(len(one.arguments) > 1 and is_variable(one.arguments[-1]) for one in patterns)
    last = [[parse_term(IDENTIFIER), *names] if identified else names]
    for pattern, *words in combine([patterns, *[names] * (unbound - 1), *last[:unbound]]):
        variables = dict.fromkeys(name for one in pattern.arguments for name in sorted(names_of(one)))
        goal = substitute(pattern, dict(zip(variables, words)))
        if len(set(goal.arguments)) == len(goal.arguments):
            yield str(goal)


def likely_patterns(program: ReactiveProgram, uses: Iterable[Use]) -> List[clingo.Symbol]:
    """Return the patterns with the fewest variables left; the other atoms of a rule give values to its variables."""
    values = ArgumentValues.of(program)
    found = dict.fromkeys(
        one
        for place, patterns in uses
        for pattern in patterns
        for one in islice(values.instances(place, pattern), MOST_INSTANCES)
        if ANY.name not in names_of(one)
    )
    least = min((len(names_of(one)) for one in found), default=0)
    return [one for one in found if len(names_of(one)) == least]


def combine(choices: Sequence[Sequence[T]]) -> Iterator[List[T]]:
    """Yield rows of different things, one of each choice, the first things first; at most :data:`MOST` rows."""
    places = sorted(product(*(range(len(choice)) for choice in choices)), key=sum)
    rows = ([choice[place] for choice, place in zip(choices, some)] for some in places)
    return islice((row for row in rows if len(set(row)) == len(row)), MOST)


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
