"""Reachable atoms: an over-approximation of the atoms that a program can derive, for any number of steps.

Negation, bounds, aggregates and constraints are dropped. Unknown values, such as steps, sums and arguments of external
facts, become :data:`~rosoclingo.planning.explaining.atom_patterns.ANY`. In most programs the remaining rules have a
small grounding, from which clingo derives all atoms. All other atoms are false in every answer, for any number of
steps.
"""

from itertools import product
from math import prod
from typing import (
    Callable,
    Container,
    Dict,
    FrozenSet,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Set,
    Tuple,
)

import clingo
from clingo.ast import ASTType, ComparisonOperator, Sign
from clingo.backend import Observer

from rosoclingo.oclingo.program.action_rules import RUNNING
from rosoclingo.oclingo.program.literals import is_plain_atom
from rosoclingo.oclingo.program.nodes import Node, parse
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import atom_terms, head_literals, signature_and_arguments
from rosoclingo.oclingo.program.survey import GENERATED, OWN
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.planning.explaining.atom_patterns import (
    ANY,
    Patterns,
    arguments_in,
    is_variable,
    matches,
    names_of,
    patterns_of,
    substitute,
)

_MOST = 50_000  # greatest number of ground rules
_MOST_WAYS = 64  # greatest number of variants of a rule
_DEEPEST = 6  # greatest difference of depths
_BY_RULE = f"{OWN}_by_rule"
_ANYTHING = clingo.Function("_")
_RUNNING_RULE = "_running(A,P,C) :- _action_lib(A,P,C)."

_OPERATORS = {
    ComparisonOperator.Equal: "=",
    ComparisonOperator.NotEqual: "!=",
    ComparisonOperator.LessThan: "<",
    ComparisonOperator.LessEqual: "<=",
    ComparisonOperator.GreaterThan: ">",
    ComparisonOperator.GreaterEqual: ">=",
}


Argument = Tuple[Signature, int]
"""An argument of a predicate."""

_Edges = Dict[Argument, Set[Tuple[Argument, int]]]


class UncertainError(Exception):
    """The reachable atoms of the program cannot be computed."""


class Condition(NamedTuple):
    """An atom of a rule: its term, and its patterns."""

    term: Node
    signature: Signature
    patterns: Patterns


class Comparison(NamedTuple):
    """A comparison in a rule."""

    left: Patterns
    operator: str
    right: Patterns

    @property
    def names(self) -> FrozenSet[str]:
        """Its variables."""
        return _names((*self.left, *self.right))

    def bound_by(self, known: Set[str]) -> Iterator[str]:
        """Yield the variable to which an equation gives a value."""
        for one, other in ((self.left, self.right), (self.right, self.left)):
            if self.operator == "=" and len(one) == 1 and is_variable(one[0]) and _names(other) <= known:
                yield one[0].name


class HeadRule(NamedTuple):
    """A head atom that a statement derives or declares, with its positive conditions.

    Attributes:
        statement: the statement.
        head: an atom of its head.
        body: the positive atoms of its body and condition.
        comparisons: the comparisons of its body and condition.

    """

    statement: Node
    head: Condition
    body: Tuple[Condition, ...]
    comparisons: Tuple[Comparison, ...]


class Reach:
    """The reachable atoms of a program.

    Attributes:
        rules: the rules, without the dropped conditions.
        free: the predicates with unknown atoms.
        known: the given atoms.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        known: Optional[Iterable[clingo.Symbol]] = None,
        numbered: Container[Signature] = (),
        free: Iterable[Signature] = (),
    ) -> None:
        """Compute the atoms that are reachable from ``known`` ones; raises UncertainError.

        Without ``known`` atoms, all declared externals can be true. :meth:`derived_by` is available for rules of
        ``numbered`` predicates. Atoms of ``free`` predicates are not computed.
        """
        survey = program.survey
        self._constants = {**survey.constants, **dict.fromkeys(survey.unvalued, ANY)}
        kinds = [ASTType.Rule] if known is not None else [ASTType.Rule, ASTType.External]
        self.rules = [
            rule
            for part in program.parts
            for statement in part.statements
            if statement.ast_type in kinds and statement.location.begin.filename not in GENERATED
            for rule in self._rules_of(statement, part.parameter)
        ]
        used = {one.signature for rule in self.rules for one in rule.body} | survey.using.keys()
        self.free: Set[Signature] = set(free) if known is not None else {*free, *survey.opened, *(used - survey.known)}
        self._all_rules = [*self.rules, *(self._core_rules() if known is None else ())]
        self._growing = _growing(self._all_rules)
        self._exact: Dict[int, Set[str]] = {}
        self._open = self._open_arguments()
        self.known = [one for one in known or () if not one.name.startswith(OWN)]
        lines = [f"{{ {self._without_steps(one)} }}." for one in self.known]
        for number, rule in enumerate(self._all_rules):
            if rule.head.signature not in self.free:
                lines += self._texts(rule, number, rule.head.signature in numbered)
        self._control = _ground("\n".join(lines))
        self._atoms: Dict[Signature, List[clingo.Symbol]] = {}
        self._by_rule: Dict[int, List[clingo.Symbol]] = {}
        for index, atom in (one.arguments for one in self.atoms(Signature(_BY_RULE, 2))):
            self._by_rule.setdefault(index.number, []).append(atom)

    def is_possible(self, atom: clingo.Symbol) -> bool:
        """Return whether a reachable atom matches the pattern ``atom``."""
        signature = signature_of(atom)
        return signature in self.free or any(matches(atom, one, {}) for one in self.atoms(signature))

    def atoms(self, signature: Signature) -> List[clingo.Symbol]:
        """Return the reachable atoms of a predicate."""
        if signature not in self._atoms:
            self._atoms[signature] = [one.symbol for one in self._control.symbolic_atoms.by_signature(*signature)]
        return self._atoms[signature]

    def derived_by(self, rule: int) -> List[clingo.Symbol]:
        """Return the atoms that a rule of a numbered predicate derives; ``rule`` is its index in ``rules``."""
        return self._by_rule.get(rule, [])

    def patterns(self, term: Node, step: str) -> Patterns:
        """Return the patterns of a term in a rule whose step parameter is ``step``, empty in base."""
        return patterns_of(term, {**self._constants, step: ANY})

    def pattern(self, term: Node, parameter: str) -> clingo.Symbol:
        """Return the only pattern of an atom; raises UncertainError if it is a pool."""
        found = self.patterns(term, parameter)
        if len(found) != 1:
            raise UncertainError("an atom is a pool")
        return found[0]

    # -- rules

    def _rules_of(self, statement: Node, step: str) -> Iterator[HeadRule]:
        for term, condition in _declared(statement) or positive_heads(statement):
            head = self._condition(term, step)
            if head.signature.name.startswith(OWN):
                continue
            literals = [one for one in (*condition, *statement.body) if one.ast_type == ASTType.Literal]
            atoms = [one.atom for one in literals if one.sign == Sign.NoSign]
            symbols = [one.symbol for one in atoms if one.ast_type == ASTType.SymbolicAtom]
            body = tuple(self._condition(one, step) for one in symbols if one.ast_type != ASTType.Pool)
            compared = [one for one in atoms if one.ast_type == ASTType.Comparison]
            comparisons = tuple(found for one in compared for found in self._comparisons(one, step))
            yield HeadRule(statement, _inlined(head, body, comparisons), body, comparisons)

    def _core_rules(self) -> List[HeadRule]:
        """Return a rule for the external ``_running``, which the core states only about actions of the program."""
        if RUNNING not in self.free:
            return []
        self.free.discard(RUNNING)
        rules = (one for one in parse(_RUNNING_RULE) if one.ast_type == ASTType.Rule)
        return [rule for one in rules for rule in self._rules_of(one, "")]

    def _condition(self, term: Node, step: str) -> Condition:
        return Condition(term, signature_and_arguments(term)[0], self.patterns(term, step))

    def _comparisons(self, atom: Node, step: str) -> Iterator[Comparison]:
        left = self.patterns(atom.term, step)
        for guard in atom.guards:
            right = self.patterns(guard.term, step)
            yield Comparison(left, _OPERATORS[guard.comparison], right)
            left = right

    # -- arguments with unknown values or parts

    def _open_arguments(self) -> Set[Argument]:
        """Return the arguments with unknown values, and store the exact variables of each rule."""
        found = {(one, number) for one in self.free for number in range(one.arity)}
        before = -1
        while before != len(found):
            before = len(found)
            for number, rule in enumerate(self._all_rules):
                self._exact[number] = _exact(rule, found)
                exact = self._exact[number] - self._growing.get(number, set())
                rows = (enumerate(one.arguments) for one in rule.head.patterns)
                found |= {(rule.head.signature, n) for row in rows for n, one in row if not names_of(one) <= exact}
        return found

    def _without_steps(self, atom: clingo.Symbol) -> clingo.Symbol:
        """Return an atom with ANY instead of numbers in open arguments, such as its step."""
        arguments = [
            ANY if one.type is clingo.SymbolType.Number and (signature_of(atom), number) in self._open else one
            for number, one in enumerate(atom.arguments)
        ]
        return clingo.Function(atom.name, arguments, atom.positive)

    # -- rules as text

    def _texts(self, rule: HeadRule, number: int, numbered: bool) -> Iterator[str]:
        """Yield the variants of a rule in clingo's language, which cover all ways to satisfy its body."""
        exact, conditions = self._exact[number], [one for one in rule.body if one.signature not in self.free]
        tests = [
            [f"{left}{one.operator}{right}" for left in one.left for right in one.right]
            for one in rule.comparisons
            if one.names <= exact
        ]
        kept = set(exact)
        ways = [self._ways(one, kept, _loosened) for one in conditions]
        if prod(map(len, ways)) > _MOST_WAYS:
            kept = set(exact)
            ways = [self._ways(one, kept, _loosest) for one in conditions]
        if prod([*map(len, ways), *map(len, tests)]) > _MOST:
            raise UncertainError("a rule has too many alternatives")
        growing = self._growing.get(number, set())
        for way in product(*ways):
            bound = exact.union(*map(names_of, way)) - growing
            values = {name: clingo.Function(name) for name in bound}
            for test in product(*tests):
                body = ", ".join([*map(str, way), *test])
                for head in (substitute(pattern, values) for pattern in rule.head.patterns):
                    yield f"{head} :- {body}."
                    if numbered:
                        yield f"{_BY_RULE}({number},{head}) :- {body}."

    def _ways(
        self, condition: Condition, kept: Set[str], loosened: Callable[[clingo.Symbol, Set[str]], List[clingo.Symbol]]
    ) -> List[clingo.Symbol]:
        """Return the patterns of atoms that satisfy a condition; the first occurrence of a variable binds it."""
        found: List[clingo.Symbol] = []
        for pattern in condition.patterns:
            rows = [
                loosened(one, kept) if (condition.signature, number) in self._open else [_body_pattern(one)]
                for number, one in enumerate(pattern.arguments)
            ]
            found += [clingo.Function(pattern.name, row, pattern.positive) for row in product(*rows)]
        return found


def _inlined(head: Condition, body: Sequence[Condition], comparisons: Sequence[Comparison]) -> Condition:
    """Return a head in which terms replace the variables that only equations bind."""
    if not comparisons:
        return head
    known = _names(pattern for one in body for pattern in one.patterns)
    equal = [one for one in comparisons if one.operator == "=" and len(one.left) == len(one.right) == 1]
    sides = [(one.left[0], one.right[0]) for one in equal] + [(one.right[0], one.left[0]) for one in equal]
    values = {left.name: right for left, right in sides if is_variable(left) and left.name not in known}
    names = {name: clingo.Function(name) for name in _names(head.patterns)}
    patterns = tuple(substitute(one, {**names, **values}) for one in head.patterns) if values else head.patterns
    return head._replace(patterns=patterns)


def _exact(rule: HeadRule, opened: Set[Argument]) -> Set[str]:
    """Return the variables of a rule with known values."""
    found: Set[str] = set()
    for one in rule.body:
        places = [n for n in range(one.signature.arity) if (one.signature, n) not in opened]
        rows = [_names(pattern.arguments[n] for n in places) for pattern in one.patterns] if places else []
        found |= frozenset.intersection(*rows) - {ANY.name} if rows else frozenset()
    for _ in rule.comparisons:
        for comparison in rule.comparisons:
            found.update(comparison.bound_by(found))
    return found


def _names(patterns: Iterable[clingo.Symbol]) -> FrozenSet[str]:
    return frozenset().union(*map(names_of, patterns))


def _growing(rules: Sequence[HeadRule]) -> Dict[int, Set[str]]:
    """Return the variables that would make terms grow without bound, by the index of the rule.

    Such a variable is deeper in the head than in the body, and other rules lead from the argument of the head back to
    that of the body without reducing the depth by as much.
    """
    edges: _Edges = {}
    deeper: Dict[Tuple[Argument, Argument, int], List[Tuple[int, str]]] = {}
    for number, rule in enumerate(rules):
        heads = list(_depths(rule.head))
        for name, depth, argument in (one for condition in rule.body for one in _depths(condition)):
            for head, growth in ((head, other - depth) for its, other, head in heads if its == name):
                edges.setdefault(argument, set()).add((head, growth))
                if growth > 0:
                    deeper.setdefault((argument, head, growth), []).append((number, name))
    found: Dict[int, Set[str]] = {}
    for (argument, head, growth), places in deeper.items():
        if _grows_to(argument, head, growth, edges):
            for number, name in places:
                found.setdefault(number, set()).add(name)
    return found


def _grows_to(
    goal: Argument, start: Argument, growth: int, edges: Mapping[Argument, Set[Tuple[Argument, int]]]
) -> bool:
    """Return whether a term that enters ``start`` deeper by ``growth`` can reach ``goal`` with a greater depth."""
    waiting, seen = [(start, growth)], {(start, growth)}
    while waiting:
        argument, depth = waiting.pop()
        if argument == goal and depth > 0:
            return True
        for other, more in edges.get(argument, ()):
            state = other, min(depth + more, _DEEPEST)
            if state[1] > -_DEEPEST and state not in seen:
                seen.add(state)
                waiting.append(state)
    return False


def _depths(condition: Condition) -> Iterator[Tuple[str, int, "Argument"]]:
    """Yield the variables of an atom, each with its depth and its argument."""
    for pattern in condition.patterns:
        for number, one in enumerate(pattern.arguments):
            waiting = [(one, 0)] if names_of(one) else []
            while waiting:
                term, depth = waiting.pop()
                if is_variable(term):
                    yield term.name, depth, (condition.signature, number)
                else:
                    waiting += [(part, depth + 1) for part in arguments_in(term)]


def _loosened(pattern: clingo.Symbol, kept: Set[str]) -> List[clingo.Symbol]:
    """Return the patterns of values with unknown parts that match a pattern."""
    if pattern == ANY:
        return [_ANYTHING]
    if is_variable(pattern):
        if pattern.name in kept:
            return [_ANYTHING]
        kept.add(pattern.name)
        return [pattern]
    if pattern.type is not clingo.SymbolType.Function or not pattern.arguments:
        return [pattern, ANY]
    rows = [_loosened(one, kept) for one in pattern.arguments]
    return [*(clingo.Function(pattern.name, row, pattern.positive) for row in product(*rows)), ANY]


def _loosest(pattern: clingo.Symbol, kept: Set[str]) -> List[clingo.Symbol]:
    """Return a single pattern that covers those of :func:`_loosened`."""
    return _loosened(pattern, kept) if is_variable(pattern) else [_ANYTHING]


def _body_pattern(pattern: clingo.Symbol) -> clingo.Symbol:
    """Return a pattern as a term of a body, with an anonymous variable for ANY."""
    if pattern == ANY:
        return _ANYTHING
    if ANY.name not in names_of(pattern):
        return pattern
    return clingo.Function(pattern.name, list(map(_body_pattern, pattern.arguments)), pattern.positive)


def _declared(statement: Node) -> List[Tuple[Node, Sequence[Node]]]:
    """Return the atoms that an ``#external`` declares; none for other statements."""
    external = statement.ast_type == ASTType.External
    return [(term, ()) for term in atom_terms(statement.atom.symbol)] if external else []


def positive_heads(statement: Node) -> Iterator[Tuple[Node, Sequence[Node]]]:
    """Yield the positive head atoms of a rule with their conditions."""
    for literal, condition in head_literals(statement.head):
        if is_plain_atom(literal):
            yield from ((term, condition) for term in atom_terms(literal.atom.symbol))


def mentions(node: Node, step: str) -> int:
    """Return how often the step occurs in a statement or term."""
    return sum(one.ast_type == ASTType.SymbolicTerm and str(one) == step for one in node.nodes)


class _Counter(Observer):
    def __init__(self) -> None:
        self._left = _MOST

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Count a rule."""
        self._left -= 1
        if self._left < 0:
            raise UncertainError(f"there are more than {_MOST} ground rules")


def _ground(text: str) -> clingo.Control:
    """Ground the rules in ``text``; raises UncertainError if there are too many instances."""
    control = clingo.Control(["-Wnone"], logger=lambda code, message: None)
    control.register_observer(_Counter(), replace=True)  # only the atoms are needed, not the rules
    try:
        control.add("base", [], text)
        control.ground([("base", [])])
    except RuntimeError as error:
        raise UncertainError(str(error)) from None
    return control
