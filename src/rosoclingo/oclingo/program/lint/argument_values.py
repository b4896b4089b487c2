"""Which values the arguments of predicates may have, read from the rules alone: never too few, at times too many.

Each argument of a predicate has a set of ground terms, or any. They are found by going through the rules until nothing
changes: a head has the values that the positive atoms, equations and inequations of the body leave to its variables.
What is open (``#external p/n.``), undefined, or a number that counts steps may be anything. A predicate is split by its
first argument where a head has a constant there, as in ``_action_lib(pickup,Id,t)``, or a variable with few values: the
other arguments have a set for each of these.
"""

from heapq import heappop, heappush
from typing import Dict, FrozenSet, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType, ComparisonOperator, Sign

from rosoclingo.oclingo.program.lint.survey import Survey
from rosoclingo.oclingo.program.lint.term_shapes import (
    MOST,
    WILD,
    Bindings,
    Inside,
    Shape,
    Values,
    common,
    fixed,
    is_open,
    matches,
    restrict,
    shape_of,
    value_of,
)
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import arguments_of, atom_terms, term_signature
from rosoclingo.oclingo.progression.terms import Signature, signature_of

Row = List[Values]
"""What the arguments of a predicate may be."""

_FEW = 8  # values of a variable by which a predicate is split


class Condition(NamedTuple):
    """A positive atom on which a rule depends."""

    term: Node
    signature: Signature
    arguments: Tuple[Shape, ...]

    @property
    def names(self) -> Set[str]:
        """Its variables."""
        return {name for argument in self.arguments for name in argument.names}


class Equation(NamedTuple):
    """A comparison of a variable with a term: they are equal, or they differ."""

    variable: str
    other: Shape
    equal: bool


class Rule(NamedTuple):
    """What a statement makes true, or says of, where its conditions hold.

    Attributes:
        parameter: the step's name in the statement, empty in base.
        head: an atom, as those of the body.
        atoms: the positive atoms on which it depends.
        equations: the comparisons on which it depends.

    """

    parameter: str
    head: Condition
    atoms: List[Condition]
    equations: List[Equation]


class Disjoint(NamedTuple):
    """A variable that has no value in common for an atom, ``its``, and for those up to another, ``others``."""

    variable: str
    atom: Condition
    its: FrozenSet[clingo.Symbol]
    other: Condition
    others: FrozenSet[clingo.Symbol]


def parted(term: Node) -> Tuple[Signature, Sequence[Node]]:
    """Return an atom's predicate and its arguments."""
    return term_signature(term), arguments_of(term)


class ArgumentValues:
    """The values of all arguments of a program's predicates."""

    def __init__(self, survey: Survey) -> None:
        self._constants = {**survey.constants, **dict.fromkeys(survey.unvalued, WILD)}
        parts = [(statement, part.parameter) for part, statement, _ in survey.statements]
        self.rules = [rule for statement, step in parts for rule in _rules(statement, step, self._constants)]
        known = {*survey.defining, *survey.declaring}
        used = {atom.signature for rule in self.rules for atom in rule.atoms}
        #: the predicates of which nothing is known: they may be true of anything
        self.free: Set[Signature] = {*survey.opened, *((used | set(survey.using)) - known)}
        self._found: Dict[Signature, Dict[Optional[clingo.Symbol], Row]] = {}
        self._spread()

    @classmethod
    def of_survey(cls, survey: Survey) -> "ArgumentValues":
        """Return the values of a program, found once for all who ask."""
        if not isinstance(survey.values, cls):
            survey.values = cls(survey)
        return survey.values

    def is_possible(self, signature: Signature) -> bool:
        """Tell whether some atom of the predicate may ever be true."""
        return signature in self.free or signature in self._found

    def of(self, signature: Signature, position: int) -> Values:
        """Return the values of an argument."""
        if signature in self.free or signature not in self._found:
            return None
        return _joined(self._found[signature].values())[position]

    def is_split(self, signature: Signature) -> bool:
        """Tell whether the other arguments of a predicate have a set for each value of its first one."""
        return signature in self._found and None not in self._found[signature]

    def misfit(self, atom: clingo.Symbol) -> Optional[Tuple[int, List[clingo.Symbol]]]:
        """Return the position of the first argument that a ground atom can't have, and what it may be there."""
        arguments = [fixed(one) for one in atom.arguments]
        return self._misfit(signature_of(atom), arguments)

    def misfitting(self, term: Node, step: str) -> Optional[Tuple[int, List[clingo.Symbol]]]:
        """Return the same for an atom of a rule in a part with this parameter."""
        signature, arguments = parted(term)
        return self._misfit(signature, [shape_of(one, step, self._constants) for one in arguments])

    def bindings(self, rule: Rule, given: Optional[Bindings] = None) -> Optional[Bindings]:
        """Return what the variables of a rule may be, None where its conditions can never hold.

        Those of ``given`` may have its values alone.
        """
        found: Bindings = dict(given or {})
        if all(self._bind(atom, found) for atom in rule.atoms) and all(_compare(one, found) for one in rule.equations):
            return found
        return None

    def disjoint(self, rule: Rule) -> Optional[Disjoint]:
        """Return where a rule joins what has nothing in common; None where it does not, or an atom is never true."""
        found: Bindings = {}
        telling: Dict[str, Condition] = {}
        for atom in rule.atoms:
            before = dict(found)
            if not self._bind(atom, found):
                return self._apart(atom, before, telling)
            telling.update(dict.fromkeys((one.variable for one in atom.arguments if one.variable), atom))
        return None

    def _apart(self, atom: Condition, before: Bindings, telling: Mapping[str, Condition]) -> Optional[Disjoint]:
        alone: Bindings = {}
        if self._bind(atom, alone):
            for name, its in alone.items():
                if name in telling and name in before and not common(before[name], its):
                    return Disjoint(name, atom, its, telling[name], before[name])
        return None

    def value(self, term: Node, step: str, bound: Bindings) -> Values:
        """Return what a term may be."""
        return value_of(shape_of(term, step, self._constants), bound)

    # ---- the search ------------------------------------------------------------------------------------------------

    def _spread(self) -> None:
        """Go through the rules until nothing changes; what a rule depends on comes first, unless that goes round."""
        rules = _sources_first(self.rules)
        users: Dict[Signature, List[int]] = {}
        for number, rule in enumerate(rules):
            for atom in rule.atoms:
                users.setdefault(atom.signature, []).append(number)
        turns = list(range(len(rules)))  # a heap
        waiting = set(turns)
        while turns:
            number = heappop(turns)
            waiting.remove(number)
            changed = self._apply(rules[number])
            for user in users.get(changed, ()) if changed is not None else ():
                if user not in waiting:
                    waiting.add(user)
                    heappush(turns, user)

    def _apply(self, rule: Rule) -> Optional[Signature]:
        """Add what a rule gives its head; return the head's predicate where there is something new."""
        signature = rule.head.signature
        bound = self.bindings(rule) if signature not in self.free else None
        if bound is None:
            return None
        rows, changed = self._found.get(signature, {}), False
        for tag, inside in self._split(rule, bound):
            fresh = [value_of(one, inside) for one in rule.head.arguments]
            fresh[:1] = fresh[:1] if tag is None else [frozenset({tag})]
            if any(one is not None and not one for one in fresh):
                continue
            known = rows.get(tag)
            joined = fresh if known is None else _joined([known, fresh])
            if joined != known:
                rows = self._found.setdefault(signature, rows)
                rows[tag], changed = joined, True
        return signature if changed else None

    def _split(self, rule: Rule, bound: Bindings) -> Iterator[Tuple[Optional[clingo.Symbol], Bindings]]:
        """Yield what the variables of a rule may be for each first argument of its head; None for any of these."""
        first = rule.head.arguments[0] if len(rule.head.arguments) > 1 else None
        values = None if first is None else value_of(first, bound)
        few = first is not None and values is not None and len(values) <= _FEW and not any(map(is_open, values))
        if values is not None and first is not None and not first.names and (few or first.is_constant):
            yield from ((value, bound) for value in values)
        elif values is not None and first is not None and few and first.variable:
            for value in values:
                inside = self.bindings(rule, {first.variable: frozenset({value})})
                if inside is not None:
                    yield value, inside
        else:
            yield None, bound

    def _row(self, signature: Signature, arguments: Sequence[Shape], found: Optional[Bindings] = None) -> Optional[Row]:
        """Return the values of a predicate's arguments where the first one is as an atom has it; None for no such."""
        rows = self._found[signature]
        if len(rows) == 1 and None in rows:
            return rows[None]
        first = arguments[0]
        among = (found or {}).get(first.variable)
        if among is not None and any(map(is_open, among)):
            among = None
        alike = [row for tag, row in rows.items() if tag is None or _fits(first, tag, among)]
        return _joined(alike) if alike else None

    def _misfit(self, signature: Signature, arguments: Sequence[Shape]) -> Optional[Tuple[int, List[clingo.Symbol]]]:
        if signature in self.free or signature not in self._found:
            return None
        row = self._row(signature, arguments)
        told = _joined(self._found[signature].values()) if row is None else row
        for position, (argument, known) in enumerate(zip(arguments, told)):
            if known is not None and not _may_be(argument, known):
                return position, sorted(known)
        return None

    def _bind(self, atom: Condition, found: Bindings) -> bool:
        """Narrow ``found`` to what an atom leaves; False where it can't be true."""
        if atom.signature in self.free:
            return True
        row = self._row(atom.signature, atom.arguments, found) if atom.signature in self._found else None
        return row is not None and all(
            known is None or _narrow(argument, known, found) for argument, known in zip(atom.arguments, row)
        )


def _fits(first: Shape, tag: clingo.Symbol, among: Optional[FrozenSet[clingo.Symbol]]) -> bool:
    return (among is None or tag in among) and matches(first, tag, {})


def _may_be(argument: Shape, known: FrozenSet[clingo.Symbol]) -> bool:
    if argument.is_constant:
        return bool(common(known, argument.values))
    return any(matches(argument, one, {}) for one in known)


def _narrow(argument: Shape, known: FrozenSet[clingo.Symbol], found: Bindings) -> bool:
    """Narrow ``found`` to what an argument leaves that is one of ``known``; False where it can't be."""
    if argument.variable:
        return restrict(found, argument.variable, known)
    taken: Inside = {}
    matched = False
    for symbol in known:
        inside: Inside = {}
        if matches(argument, symbol, inside):
            matched = True
            for name, values in inside.items():
                taken.setdefault(name, set()).update(values)
    known_names = [name for name, values in taken.items() if WILD not in values]
    return matched and all(restrict(found, name, frozenset(taken[name])) for name in known_names)


def _compare(one: Equation, found: Bindings) -> bool:
    """Narrow ``found`` to what a comparison leaves; False where that is nothing."""
    values = value_of(one.other, found)
    if values is None:
        return True
    if one.equal:
        return restrict(found, one.variable, values)
    if len(values) == 1 and one.variable in found and not any(map(is_open, values)):
        found[one.variable] -= values
        return bool(found[one.variable])
    return True


# ---- rules ----------------------------------------------------------------------------------------------------------

_Constants = Mapping[str, clingo.Symbol]


def _rules(statement: Node, step: str, constants: _Constants) -> Iterator[Rule]:
    """Yield what a statement defines or declares."""
    body = list(statement.body) if hasattr(statement, "body") else []
    if statement.ast_type == ASTType.External:
        for term in atom_terms(statement.atom.symbol):
            yield _rule(step, term, body, constants)
    elif statement.ast_type == ASTType.Rule:
        for literal, condition in head_literals(statement.head):
            if literal.sign == Sign.NoSign and literal.atom.ast_type == ASTType.SymbolicAtom:
                for term in atom_terms(literal.atom.symbol):
                    yield _rule(step, term, [*condition, *body], constants)


def _rule(step: str, head: Node, literals: Sequence[Node], constants: _Constants) -> Rule:
    """Return the rule of a head with what its body and condition say for certain."""
    plain = [one.atom for one in literals if one.ast_type == ASTType.Literal and one.sign == Sign.NoSign]
    symbols = [one.symbol for one in plain if one.ast_type == ASTType.SymbolicAtom]
    atoms = [_condition(one, step, constants) for one in symbols if one.ast_type != ASTType.Pool]
    comparisons = [one for one in plain if one.ast_type == ASTType.Comparison and len(one.guards) == 1]
    equations = [found for one in comparisons for found in _equations(one, step, constants)]
    return Rule(step, _condition(head, step, constants), atoms, equations)


def _condition(term: Node, step: str, constants: _Constants) -> Condition:
    signature, arguments = parted(term)
    return Condition(term, signature, tuple(shape_of(one, step, constants) for one in arguments))


def _equations(comparison: Node, step: str, constants: _Constants) -> Iterator[Equation]:
    guard = comparison.guards[0]
    if guard.comparison in (ComparisonOperator.Equal, ComparisonOperator.NotEqual):
        left, right = (shape_of(one, step, constants) for one in (comparison.term, guard.term))
        for one, other in ((left, right), (right, left)):
            if one.variable:
                yield Equation(one.variable, other, guard.comparison == ComparisonOperator.Equal)


def head_literals(head: Node) -> Iterator[Tuple[Node, Sequence[Node]]]:
    """Yield the literals of a head, each with its condition."""
    if head.ast_type == ASTType.Literal:
        yield head, ()
    elif head.ast_type in (ASTType.Disjunction, ASTType.Aggregate, ASTType.HeadAggregate):
        for element in head.elements:
            one = element.condition if element.ast_type == ASTType.HeadAggregateElement else element
            if one.ast_type == ASTType.ConditionalLiteral:
                yield one.literal, list(one.condition)


def _sources_first(rules: Sequence[Rule]) -> List[Rule]:
    """Return the rules, each behind those that define what it depends on, as far as can be."""
    defining: Dict[Signature, List[int]] = {}
    for number, rule in enumerate(rules):
        defining.setdefault(rule.head.signature, []).append(number)
    found: List[Rule] = []
    seen: Set[int] = set()
    waiting = [(number, False) for number in reversed(range(len(rules)))]
    while waiting:
        number, done = waiting.pop()
        if done:
            found.append(rules[number])
        elif number not in seen:
            seen.add(number)
            waiting.append((number, True))
            waiting += [(one, False) for atom in rules[number].atoms for one in defining.get(atom.signature, ())]
    return found


def _joined(rows: Iterable[Row]) -> Row:
    """Return what any of some rows has."""
    found: Row = []
    for row in rows:
        found = [_join(*pair) for pair in zip(found, row)] if found else row
    return found


def _join(one: Values, other: Values) -> Values:
    joined = None if one is None or other is None else one | other
    return None if joined is None or len(joined) > MOST else joined
