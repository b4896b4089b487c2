"""Which values the arguments of predicates may have, read from the rules alone: never too few, at times too many.

Each argument of a predicate has a set of ground terms, or any. They are found by going through the rules until nothing
changes: a head has the values that the positive atoms, equations and inequations of the body leave to its variables.
Values that are open (``#external p/n.``), undefined, or numbers of steps are unrestricted. A predicate is split by its
first argument where a head has a constant there, as in ``_action_lib(pickup,Id,t)``. A predicate that gives actions
their parameters is also split where a head has a variable with few values. The other arguments have a set for each of
these.
"""

from heapq import heappop, heappush
from typing import Dict, FrozenSet, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

import clingo

from rosoclingo.checking.lint.rule_shapes import Condition, Equation, Rule, rules_of
from rosoclingo.checking.lint.term_shapes import (
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
from rosoclingo.oclingo.program.action_rules import ACTION
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import parted
from rosoclingo.oclingo.program.survey import Survey
from rosoclingo.oclingo.progression.terms import Signature, signature_of

Row = List[Values]
"""What the arguments of a predicate may be."""

_FEW = 8  # values of a variable by which a predicate is split


class Disjoint(NamedTuple):
    """A variable that has no value in common for an atom, ``its``, and for those up to another, ``others``."""

    variable: str
    atom: Condition
    its: FrozenSet[clingo.Symbol]
    other: Condition
    others: FrozenSet[clingo.Symbol]


class ArgumentValues:
    """The values of all arguments of a program's predicates."""

    def __init__(self, survey: Survey) -> None:
        self._constants = {**survey.constants, **dict.fromkeys(survey.unvalued, WILD)}
        parts = [(statement, part.parameter) for part, statement, _ in survey.statements]
        self.rules = [rule for statement, step in parts for rule in rules_of(statement, step, self._constants)]
        known = {*survey.defining, *survey.declaring}
        used = {atom.signature for rule in self.rules for atom in rule.atoms}
        #: the predicates of which nothing is known: they may be true of anything
        self.free: Set[Signature] = {*survey.opened, *((used | set(survey.using)) - known)}
        self._telling = _telling(self.rules)
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
        """Return the possible values of a rule's variables, None if its conditions can never hold.

        Variables in ``given`` have only its values.
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
        """Yield each first argument of a rule's head, None for any, with the possible values of its variables."""
        if len(rule.head.arguments) < 2:
            yield None, bound
            return
        first = rule.head.arguments[0]
        values = value_of(first, bound) if not first.names or rule.head.signature in self._telling else None
        few = values is not None and len(values) <= _FEW and not any(map(is_open, values))
        if values is not None and not first.names and (few or first.is_constant):
            yield from ((value, bound) for value in values)
        elif values is not None and few and first.variable:
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


def _telling(rules: Sequence[Rule]) -> Set[Signature]:
    """Return the predicates that give actions, by their first argument, their parameters."""
    found: Set[Signature] = set()
    waiting = [ACTION]
    while waiting:
        signature = waiting.pop()
        for rule in rules:
            for atom in rule.atoms if rule.head.signature == signature else ():
                if (
                    atom.signature not in found
                    and atom.arguments
                    and is_same(atom.arguments[0], rule.head.arguments[0])
                ):
                    found.add(atom.signature)
                    waiting.append(atom.signature)
    return found


def is_same(argument: Shape, first: Shape) -> bool:
    """Tell whether two arguments are the same variable or constant."""
    return argument.variable == first.variable if first.variable else argument.is_constant and argument == first


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
