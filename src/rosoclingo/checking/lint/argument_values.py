"""The possible argument values of predicates, an over-approximation computed from the rules."""

from functools import lru_cache
from typing import Dict, Iterator, List, Optional, Sequence, Set, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import ACTION
from rosoclingo.oclingo.program.literals import plain_literals
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Occurrence
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import term_signature
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.planning.explaining.atom_patterns import (
    ANY,
    Bound,
    Patterns,
    arguments_in,
    is_variable,
    matches,
    names_of,
    patterns_of,
    substitute,
)
from rosoclingo.planning.explaining.reach import Condition, HeadRule, Reach, UncertainError

STATUS = Signature("_status", 3)

_MOST = 2000  # greatest number of atoms of a predicate whose values are compared
_TRANSITION = "_g_"  # prefix of the predicates of encodings/golog/transitions.lp: many atoms, none written by users

ImpossibleArgument = Tuple[int, List[clingo.Symbol]]
"""The position of an impossible argument, and the values that are possible there."""


Disjoint = Tuple[str, Condition, Set[clingo.Symbol], Condition, Set[clingo.Symbol]]
"""A variable, and two atoms in which it has no common value, each with its values there."""


class ArgumentValues:
    """The values of all arguments of a program's predicates.

    Attributes:
        rules: the rules of the program; empty if the values are unknown.

    """

    def __init__(self, program: ReactiveProgram) -> None:
        self._constants = program.survey.constants
        self._reach: Optional[Reach] = None
        self.rules: Sequence[HeadRule] = ()
        self._columns: Dict[Tuple[Signature, int, Optional[clingo.Symbol]], Set[clingo.Symbol]] = {}
        try:
            transitions = (one for one in program.head_signatures if one.name.startswith(_TRANSITION))
            self._reach = Reach(program, numbered=(ACTION, STATUS), free=transitions)
            self.rules = self._reach.rules
        except UncertainError:
            pass

    @classmethod
    @lru_cache(maxsize=1)
    def of(cls, program: ReactiveProgram) -> "ArgumentValues":
        """Return the values of a program; those of the last program are cached."""
        return cls(program)

    def is_possible(self, signature: Signature) -> bool:
        """Return whether any atom of the predicate can be true."""
        return self._is_free(signature) or bool(self.atoms(signature))

    def derived_by(self, number: int) -> List[clingo.Symbol]:
        """Return the actions or statuses that a rule derives, given by its number."""
        return [] if self._reach is None else self._reach.derived_by(number)

    def impossible_value(self, atom: clingo.Symbol) -> Optional[ImpossibleArgument]:
        """Return the first impossible argument of a ground atom."""
        return self._impossible(signature_of(atom), [(one,) for one in atom.arguments])

    def impossible_argument(self, term: Node, step: str) -> Optional[ImpossibleArgument]:
        """Return the first impossible argument of an atom in a rule whose step parameter is ``step``."""
        if self._reach is None or self._is_free(term_signature(term)):
            return None
        patterns = self._reach.patterns(term, step)
        return self._impossible(term_signature(term), [*zip(*(one.arguments for one in patterns))])

    def instances(self, place: Occurrence, pattern: clingo.Symbol) -> Iterator[clingo.Symbol]:
        """Yield instances of a pattern of terms in an atom, with values from the other positive body atoms of its rule.

        Variables without a known value remain.
        """
        names = names_of(pattern)
        conditions: List[clingo.Symbol] = []
        for term in (one.atom.symbol for one in plain_literals(place.statement)):
            if term is not place.term and not self._is_free(term_signature(term)):
                patterns = patterns_of(term, {**self._constants, place.part.parameter: ANY})
                conditions += [one for one in patterns if len(patterns) == 1 and names & names_of(one)]
        unbound = {name: clingo.Function(name) for name in names}
        yield from (substitute(pattern, {**unbound, **bound}) for bound in self._bindings(conditions, {}))

    def _bindings(self, conditions: Sequence[clingo.Symbol], bound: Bound) -> Iterator[Bound]:
        """Yield the values of variables for which all conditions are possible."""
        if not conditions:
            yield bound
            return
        for atom in self.atoms(signature_of(conditions[0])):
            values = dict(bound)
            if matches(conditions[0], atom, values):
                yield from self._bindings(conditions[1:], values)

    def disjoint(self, number: int) -> Optional[Disjoint]:
        """Return two atoms of a rule, given by its number, that share a variable without a common value."""
        known: Dict[str, Tuple[Condition, Set[clingo.Symbol]]] = {}
        body = [one for one in self.rules[number].body if not self._is_free(one.signature) and len(one.patterns) == 1]
        for condition in body if len(body) > 1 else ():
            arguments = condition.patterns[0].arguments
            for position, one in enumerate(arguments):
                values = self._column(condition.signature, position, _first(arguments)) if is_variable(one) else ()
                if values and known.setdefault(one.name, (condition, values))[1].isdisjoint(values):
                    other, others = known[one.name]
                    if not any(map(names_of, [*values, *others])):
                        return one.name, condition, set(values), other, others
        return None

    def _is_free(self, signature: Signature) -> bool:
        return self._reach is None or signature in self._reach.free or len(self.atoms(signature)) > _MOST

    def atoms(self, signature: Signature) -> Sequence[clingo.Symbol]:
        """Return the possible atoms of a predicate; none if they are unknown."""
        return () if self._reach is None else self._reach.atoms(signature)

    def _impossible(self, signature: Signature, arguments: Sequence[Patterns]) -> Optional[ImpossibleArgument]:
        if self._is_free(signature) or not self.atoms(signature):
            return None
        first = _first(arguments[0]) if arguments and len(arguments[0]) == 1 else None
        for position, patterns in enumerate(arguments):
            if not any(one == ANY or is_variable(one) for one in patterns):
                values = self._column(signature, position, first)
                known = ANY in values or not values.isdisjoint(patterns)
                if not known and not any(matches(one, value, {}) for one in patterns for value in values):
                    return position, sorted(values)
        return None

    def _column(self, signature: Signature, position: int, first: Optional[clingo.Symbol]) -> Set[clingo.Symbol]:
        """Return the values of an argument; unless ``first`` is None, only those of atoms with this first argument."""
        first = first if position else None
        key = signature, position, first
        if key not in self._columns:
            rows = map(arguments_in, self.atoms(signature))
            self._columns[key] = {row[position] for row in rows if first is None or matches(first, row[0], {})}
        return self._columns[key]


def _first(arguments: Sequence[clingo.Symbol]) -> Optional[clingo.Symbol]:
    """Return the first argument if it is ground."""
    return arguments[0] if arguments and not names_of(arguments[0]) else None
