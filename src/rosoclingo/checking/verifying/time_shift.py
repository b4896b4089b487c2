"""Shifts atoms in time, so that states of different steps can be compared.

Most programs never read the step itself: they add numbers to times and compare times with times. The states at steps 5
and 9 are then equal if their atoms are, with times relative to the step. Rules that use a time in another way, such as
``t > 100`` or a remainder of t, distinguish states of different steps.
"""

from math import prod
from typing import Dict, FrozenSet, Iterator, List, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType, BinaryOperator

from rosoclingo.oclingo.program.look_back import linear_form
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Occurrence, Part
from rosoclingo.oclingo.program.signatures import evaluate
from rosoclingo.oclingo.progression.terms import Signature, signature_of

Argument = Tuple[Signature, int]
"""An argument of a predicate."""


class TimeShift:
    """Knows which arguments of a program's predicates are times.

    Attributes:
        readings: the rules that depend on the step itself: for each, the number of steps after which its behaviour
            repeats (0 if it never does), and the predicates of earlier steps without which it does not apply.
        unclear: predicates with an argument that is a time in some rules only, or a term that contains one.

    """

    def __init__(self, parts: Sequence[Part]) -> None:
        """Analyse the ``parts`` of a program."""
        self.unclear: Set[Signature] = set()
        self.readings: List[Tuple[int, FrozenSet[Signature]]] = []
        self._times: Set[Argument] = set()
        self._time_of: Dict[clingo.Symbol, Optional[int]] = {}
        heads = {(one.signature, bool(part.parameter)) for part in parts for one in part.atoms if one.head}
        self._timeless = {one for one, stepped in heads if not stepped and (one, True) not in heads}
        rules = [
            _Rule(part, statement, found)
            for part in parts
            for statement, found in (part.found if part.parameter else ())
        ]
        for joint in (False, True):  # in sums, times are recognized only after those of single variables
            self._infer(rules, joint)
        self._places: Dict[Signature, List[int]] = {}
        for signature, place in sorted(self._times):
            self._places.setdefault(signature, []).append(place)
        for rule in rules:
            self._judge(rule)

    def time_of(self, atom: clingo.Symbol) -> Optional[int]:
        """Return the time of an atom, which is its last time argument; None if it has none."""
        if atom not in self._time_of:
            arguments = atom.arguments
            times = (arguments[place] for place in reversed(self._places.get(signature_of(atom), ())))
            numbers = (int(one.number) for one in times if one.type is clingo.SymbolType.Number)
            self._time_of[atom] = next(numbers, None)
        return self._time_of[atom]

    def shift(self, atom: clingo.Symbol, by: int) -> clingo.Symbol:
        """Return an atom with all its times ``by`` steps later."""
        places = self._places.get(signature_of(atom))
        if not places:
            return atom
        arguments = list(atom.arguments)
        for place in places:
            if arguments[place].type is clingo.SymbolType.Number:
                arguments[place] = clingo.Number(arguments[place].number + by)
        return clingo.Function(atom.name, arguments, atom.positive)

    def phase(self, step: int, visible: FrozenSet[Signature]) -> Tuple[int, ...]:
        """Return the part of ``step`` that later rules can read, given the ``visible`` predicates of earlier steps."""
        periods = {period for period, needs in self.readings if needs <= visible}
        if visible & self.unclear or 0 in periods:
            return (step,)
        return tuple(n for period in sorted(periods) for n in (period, step % period))

    def _infer(self, rules: Sequence["_Rule"], joint: bool) -> None:
        """Infer the arguments that are times, from terms with one variable or, if ``joint``, with several."""
        before = -1
        while before != len(self._times):
            before = len(self._times)
            for rule in rules:
                times = rule.times(self._times)
                self._times.update(
                    (signature, place)
                    for signature, place, term in rule.arguments
                    if signature not in self._timeless
                    and (joint or len(_names(term)) <= 1)
                    and rule.degree(term, times) == 1
                )

    def _judge(self, rule: "_Rule") -> None:
        """Note whether a rule uses times other than by adding numbers and comparing them with each other."""
        times, needs = rule.times(self._times), frozenset(rule.looks_back())
        for signature, place, term in rule.arguments:
            if rule.degree(term, times) == ((signature, place) in self._times):
                continue
            if signature in self._timeless:
                self.readings.append((0, needs))
            else:
                self.unclear.add(signature)
        for terms, alone in _compared(rule.statement):
            degrees = [rule.degree(one, times) for one in terms]
            timed = [term for term, degree in zip(terms, degrees) if degree != 0]
            if timed and (alone or None in degrees or len(set(degrees)) > 1):
                self.readings.append((prod(rule.period(one, times) for one in timed), needs))


class _Rule:
    """A statement of a part with steps; ``arguments`` are those of all its atoms."""

    def __init__(self, part: Part, statement: Node, found: List[Occurrence]) -> None:
        self.statement, self._found, self._parameter, self._constants = statement, found, part.parameter, part.constants
        self.arguments = [(one.signature, place, term) for one in found for place, term in enumerate(one.arguments)]

    def times(self, known: Set[Argument]) -> Set[str]:
        """Return the names that stand for times, given the arguments that are ``known`` to be times."""
        variables = ((one, place, term) for one, place, term in self.arguments if term.ast_type == ASTType.Variable)
        return {self._parameter, *(term.name for one, place, term in variables if (one, place) in known)} - {"_"}

    def degree(self, term: Node, times: Set[str]) -> Optional[int]:
        """Return how many times a term adds up: 1 for a time, 0 for a difference; None for other terms."""
        if not times & _names(term, symbols=True):
            return 0
        if term.ast_type == ASTType.Interval:
            ends = {self.degree(term.left, times), self.degree(term.right, times)}
            return ends.pop() if len(ends) == 1 else None
        factors = linear_form(term, self._parameter, self._constants)
        return None if factors is None else sum(factor for name, factor in factors.items() if name in times)

    def period(self, term: Node, times: Set[str]) -> int:
        """Return N if a term is a time modulo N, else 0."""
        if term.ast_type != ASTType.BinaryOperation or term.operator_type != BinaryOperator.Modulo:
            return 0
        value = evaluate(term.right, self._constants)
        timed = self.degree(term.left, times) == 1 and value is not None
        return abs(value.number) if timed and value.type is clingo.SymbolType.Number else 0  # type: ignore[union-attr]

    def looks_back(self) -> Iterator[Signature]:
        """Yield the predicates of which the rule requires an atom of an earlier step."""
        for one in self._found:
            if one.positive and any(offset < 0 for offset in one.offsets.values()):
                yield one.signature


def _compared(statement: Node) -> Iterator[Tuple[List[Node], bool]]:
    """Yield groups of compared terms, and whether each is compared with an aggregate instead."""
    for node in statement.nodes:
        if node.ast_type == ASTType.Comparison:
            yield [node.term, *(guard.term for guard in node.guards)], False
        elif node.ast_type in (ASTType.BodyAggregate, ASTType.Aggregate, ASTType.HeadAggregate):
            yield from (([one.term], True) for one in (node.left_guard, node.right_guard) if one is not None)
        elif node.ast_type == ASTType.BodyAggregateElement and node.terms:
            yield [node.terms[0]], True


def _names(term: Node, symbols: bool = False) -> Set[str]:
    """Return the names of the variables in a term, and of its constants if ``symbols``."""
    found = {one.name for one in term.nodes if one.ast_type == ASTType.Variable}
    return found | {str(one) for one in term.nodes if symbols and one.ast_type == ASTType.SymbolicTerm}
