"""States that differ in their time alone: which arguments are times, and which rules read the time itself.

A program that reads no clock does the same whenever it does it: its rules add numbers to times, and compare times with
times. Then a state at step 5 and one at step 9 are the same if they are so with all times counted from there. Rules
that do other things with a time, as by a remainder or by ``t > 100``, are told apart.
"""

from typing import Dict, FrozenSet, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType, BinaryOperator, UnaryOperator

from rosoclingo.oclingo.program.domains import names_in
from rosoclingo.oclingo.program.look_back import time_offset
from rosoclingo.oclingo.program.nodes import Node, parse
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.signatures import Occurrence, evaluate
from rosoclingo.oclingo.progression.terms import Signature, signature_of

Place = Tuple[Signature, int]
"""An argument of a predicate."""


class Reading(NamedTuple):
    """A rule that reads the time itself.

    Attributes:
        period: what it reads repeats after so many steps; 0 where it does not.
        needs: predicates of earlier steps without which it says nothing.

    """

    period: int
    needs: FrozenSet[Signature]


class TimeShift:
    """How atoms of a program are moved in time.

    Attributes:
        readings: the rules that read the time itself.
        unclear: predicates with an argument that is no plain time.

    """

    def __init__(self, parts: Sequence[Part], constants: Mapping[str, clingo.Symbol]) -> None:
        """Look through the parts of a program with these values of constants."""
        self._constants = dict(constants)
        self._degrees: Dict[Place, int] = {}
        self._times: Dict[clingo.Symbol, Optional[int]] = {}  # of atoms that were asked for
        self.unclear: Set[Signature] = set()
        self.readings: List[Reading] = []
        every = [(part.parameter, statement, found) for part in parts for statement, found in part.found]
        stepped = {one.signature for parameter, _, found in every if parameter for one in found if one.head}
        defined = {one.signature for _, _, found in every for one in found if one.head}
        self._timeless = defined - stepped
        rules = [_Rule(statement, found, parameter) for parameter, statement, found in every if parameter]
        for sure in (True, False):
            self._infer(rules, sure)
        self._places: Dict[Signature, List[int]] = {}  # the arguments that are times, in order
        for signature, place in sorted(place for place, degree in self._degrees.items() if degree == 1):
            self._places.setdefault(signature, []).append(place)
        for one in rules:
            self._judge(one)

    def time_of(self, atom: clingo.Symbol) -> Optional[int]:
        """Return the time of an atom, the last argument that is one; None where it has none."""
        if atom not in self._times:
            arguments = atom.arguments
            times = (arguments[place] for place in reversed(self._places.get(signature_of(atom), ())))
            numbers = (int(one.number) for one in times if one.type is clingo.SymbolType.Number)
            self._times[atom] = next(numbers, None)
        return self._times[atom]

    def moved(self, atom: clingo.Symbol, by: int) -> clingo.Symbol:
        """Return an atom with all its times later by so many steps."""
        places = self._places.get(signature_of(atom))
        if not places:
            return atom
        arguments = list(atom.arguments)
        for place in places:
            if arguments[place].type is clingo.SymbolType.Number:
                arguments[place] = clingo.Number(arguments[place].number + by)
        return clingo.Function(atom.name, arguments, atom.positive)

    def phase(self, step: int, visible: FrozenSet[Signature]) -> Tuple[int, ...]:
        """Return what of ``step`` itself matters to who sees, of earlier steps, atoms of the predicates ``visible``."""
        if visible & self.unclear:
            return (step,)
        found: Set[int] = set()
        for one in self.readings:
            if one.needs <= visible:
                if not one.period:
                    return (step,)
                found.add(one.period)
        return tuple(n for period in sorted(found) for n in (period, step % period))

    # -- which arguments are times

    def _infer(self, rules: Sequence["_Rule"], sure: bool) -> None:
        """Find the arguments that rules write as times, or carry on from such.

        Where that is to be ``sure``, of terms alone in which it is known of each variable what it is.
        """
        before = -1
        while before != len(self._degrees):
            before = len(self._degrees)
            for rule in rules:
                self._spread(rule, sure)

    def _spread(self, rule: "_Rule", sure: bool) -> None:
        degrees = self._variables(rule)
        for signature, place, term in rule.arguments:
            if (signature, place) in self._degrees or signature in self._timeless:
                continue
            if sure and not names_in_term(term) <= degrees.keys():
                continue
            if self._degree(term, rule, degrees) == 1:
                self._degrees[signature, place] = 1

    def _variables(self, rule: "_Rule") -> Dict[str, int]:
        """Return the variables of a rule of which it is known whether they are times."""
        found: Dict[str, int] = {}
        for signature, place, name in rule.variables:
            degree = 0 if signature in self._timeless else self._degrees.get((signature, place))
            if degree is not None:
                found[name] = max(degree, found.get(name, 0))
        return found

    def _degree(self, term: Node, rule: "_Rule", degrees: Mapping[str, int]) -> Optional[int]:
        """Return how often the time is added up in a term: 1 of a time, 0 of a difference; None where it is no sum."""
        if term.ast_type == ASTType.Variable:
            return degrees.get(term.name, 0)
        if term.ast_type == ASTType.SymbolicTerm:
            return 1 if str(term) == rule.parameter else 0
        inner = [self._degree(one, rule, degrees) for one in term.children]
        if all(one == 0 for one in inner):
            return 0
        if None in inner:
            return None
        known = [one for one in inner if one is not None]
        if term.ast_type == ASTType.BinaryOperation:
            return self._sum(term.operator_type, known)
        if term.ast_type == ASTType.UnaryOperation and term.operator_type == UnaryOperator.Minus:
            return -known[0]
        same = term.ast_type in (ASTType.Interval, ASTType.Pool) and len(set(known)) == 1
        return known[0] if same else None

    @staticmethod
    def _sum(operator: int, known: Sequence[int]) -> Optional[int]:
        if operator == BinaryOperator.Plus:
            return known[0] + known[1]
        return known[0] - known[1] if operator == BinaryOperator.Minus else None

    # -- who reads the time itself

    def _judge(self, rule: "_Rule") -> None:
        degrees = self._variables(rule)
        for signature, place, term in rule.arguments:
            degree = self._degree(term, rule, degrees)
            if degree != self._degrees.get((signature, place), 0):
                self.unclear.add(signature)
        needs = frozenset(rule.looks_back(self._constants))
        for terms in rule.compared():
            found = {self._degree(one, rule, degrees) for one in terms}
            if len(found) > 1 or None in found:
                period = max((self._period(one, rule, degrees) for one in terms), default=0)
                plain = all(self._period(one, rule, degrees) or self._degree(one, rule, degrees) == 0 for one in terms)
                self.readings.append(Reading(period if plain else 0, needs))

    def _period(self, term: Node, rule: "_Rule", degrees: Mapping[str, int]) -> int:
        """Return N where a term is a time modulo N, else 0."""
        if term.ast_type != ASTType.BinaryOperation or term.operator_type != BinaryOperator.Modulo:
            return 0
        value = evaluate(term.right, self._constants)
        number = value is not None and value.type is clingo.SymbolType.Number
        timed = self._degree(term.left, rule, degrees) == 1
        return abs(value.number) if timed and number and value is not None else 0


class _Rule:
    """A statement with its atoms, in a part with this step ``parameter``.

    Attributes:
        arguments: those of all its atoms.
        variables: those of the arguments that are variables.

    """

    def __init__(self, statement: Node, found: List[Occurrence], parameter: str) -> None:
        self.statement, self.found, self.parameter = statement, found, parameter
        self.arguments = list(self._arguments())
        self.variables = [(one, place, term.name) for one, place, term in self.arguments if _is_variable(term)]

    def _arguments(self) -> Iterator[Tuple[Signature, int, Node]]:
        for one in self.found:
            term = one.term.argument if one.term.ast_type == ASTType.UnaryOperation else one.term
            for place, argument in enumerate(term.arguments if term.ast_type == ASTType.Function else ()):
                yield one.signature, place, argument

    def looks_back(self, constants: Dict[str, clingo.Symbol]) -> Iterator[Signature]:
        """Yield the predicates of which it needs an atom of an earlier step."""
        for one in self.found:
            arguments = one.term.arguments if one.term.ast_type == ASTType.Function else ()
            offsets = [time_offset(term, self.parameter, constants) for term in arguments]
            if one.positive and any(offset is not None and offset < 0 for offset in offsets):
                yield one.signature

    def compared(self) -> Iterator[List[Node]]:
        """Yield the terms that comparisons hold against each other, and the bounds and weights of aggregates alone."""
        for child in _bodies(self.statement):
            for node in child.nodes:
                if node.ast_type == ASTType.Comparison:
                    yield [node.term, *(guard.term for guard in node.guards)]
                elif node.ast_type in (ASTType.BodyAggregate, ASTType.Aggregate, ASTType.HeadAggregate):
                    guards = [one.term for one in (node.left_guard, node.right_guard) if one is not None]
                    yield from ([term, _ZERO] for term in guards)
                elif node.ast_type == ASTType.BodyAggregateElement and node.terms:
                    yield [node.terms[0], _ZERO]


def _is_variable(term: Node) -> bool:
    return bool(term.ast_type == ASTType.Variable)


def names_in_term(term: Node) -> Set[str]:
    """Return the names of the variables in a term."""
    if term.ast_type == ASTType.Variable:
        return {term.name}
    return set() if term.ast_type == ASTType.SymbolicTerm else set(names_in(term))


_ZERO = parse("x(0).")[-1].head.atom.symbol.arguments[0]


def _bodies(statement: Node) -> Iterator[Node]:
    if hasattr(statement, "head") and isinstance(statement.head, Node):
        yield statement.head
    yield from (statement.body if hasattr(statement, "body") else ())
