"""Which values the arguments of predicates may have, read from the rules alone: never too few, at times too many.

Each argument of a predicate has a set of ground terms, or any. They are found by going through the rules until nothing
changes: a head has the values that the positive atoms, equations and inequations of the body leave to its variables.
What is open (``#external p/n.``), undefined, or a number that counts steps may be anything. Where all heads of a
predicate have a constant as their first argument, as those of ``_action_lib(pickup,Id,t)``, it is taken for as many
predicates as there are constants.
"""

from functools import lru_cache
from typing import Dict, FrozenSet, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import AST, ASTType, ComparisonOperator, Sign

from rosoclingo.oclingo.program.domains import names_in
from rosoclingo.oclingo.program.lint.survey import Survey
from rosoclingo.oclingo.program.signatures import atom_terms, evaluate, term_signature
from rosoclingo.oclingo.progression.terms import Signature, signature_of

Values = Optional[FrozenSet[clingo.Symbol]]
"""The values that a term may have; None for any."""

Row = List[Values]
"""What the arguments of a predicate may be."""

Bindings = Dict[str, FrozenSet[clingo.Symbol]]
"""The values that variables may have; one that is not there may have any."""

WILD = clingo.Function("__oclingo_any")
"""Stands inside a compound value for a part that may be anything."""

_MOST = 300  # so many values of one argument are told apart
_DEEPEST = 6  # terms of more levels are not told apart


class Rule(NamedTuple):
    """What a statement makes true, or says of, where its conditions hold.

    Attributes:
        parameter: the step's name in the statement, empty in base.
        head: the term of an atom.
        atoms: the terms of the positive atoms on which it depends.
        comparisons: the comparisons on which it depends.

    """

    parameter: str
    head: AST
    atoms: List[AST]
    comparisons: List[AST]


def parted(term: AST) -> Tuple[Signature, Sequence[AST]]:
    """Return an atom's predicate and its arguments."""
    bare = term.argument if term.ast_type == ASTType.UnaryOperation else term
    return term_signature(term), bare.arguments if bare.ast_type == ASTType.Function else ()


class ArgumentValues:
    """The values of all arguments of a program's predicates."""

    def __init__(self, survey: Survey) -> None:
        self._constants = survey.constants
        self.rules = [rule for part, statement, _ in survey.statements for rule in _rules(statement, part.parameter)]
        known = {*survey.defining, *survey.declaring}
        used = {parted(term)[0] for rule in self.rules for term in rule.atoms}
        #: the predicates of which nothing is known: they may be true of anything
        self.free: Set[Signature] = {*survey.opened, *((used | set(survey.using)) - known)}
        self._tagged = _tagged(self.rules)
        self._found: Dict[Signature, Dict[Optional[clingo.Symbol], Row]] = {}
        self._spread()

    def is_possible(self, signature: Signature) -> bool:
        """Tell whether some atom of the predicate may ever be true."""
        return signature in self.free or signature in self._found

    def of(self, signature: Signature, position: int) -> Values:
        """Return the values of an argument."""
        if signature in self.free or signature not in self._found:
            return None
        return _joined(self._found[signature].values())[position]

    def misfit(self, atom: clingo.Symbol) -> Optional[Tuple[int, List[clingo.Symbol]]]:
        """Return the position of the first argument that a ground atom can't have, and what it may be there."""
        signature = signature_of(atom)
        rows = {} if signature in self.free else self._found.get(signature, {})
        if not rows:
            return None
        alike = [row for row in rows.values() if _may_hold(row[0], atom.arguments[0])] if atom.arguments else []
        for position, argument in enumerate(atom.arguments):
            known = _joined(alike or rows.values())[position]
            if not _may_hold(known, argument):
                return position, sorted(known or ())
        return None

    def bindings(self, rule: Rule) -> Optional[Bindings]:
        """Return what the variables of a rule may be, None where its conditions can never hold."""
        found: Bindings = {}
        for term in rule.atoms:
            if not self._bind(term, rule.parameter, found):
                return None
        for literal in rule.comparisons:
            if not self._compare(literal, rule.parameter, found):
                return None
        return found

    def fits(self, term: AST, parameter: str) -> Optional[int]:
        """Return the position of the first argument of an atom that fits none of its values; None where all do."""
        misfit = self.misfitting(term, parameter)
        return None if misfit is None else misfit[0]

    def misfitting(self, term: AST, parameter: str) -> Optional[Tuple[int, List[clingo.Symbol]]]:
        """Return as well what the argument may be."""
        signature, arguments = parted(term)
        if signature in self.free or signature not in self._found:
            return None
        row = self._row(signature, arguments, parameter)
        told = _joined(self._found[signature].values()) if row is None else row
        for position, (argument, known) in enumerate(zip(arguments, told)):
            if known is not None and not any(self._match(argument, one, parameter, {}) for one in known):
                return position, sorted(known)
        return None

    def value(self, term: AST, parameter: str, bound: Bindings) -> Values:
        """Return what a term may be."""
        found = self._value(term, parameter, bound)
        return None if found is None or len(found) > _MOST or any(_depth(one) > _DEEPEST for one in found) else found

    # ---- the search ------------------------------------------------------------------------------------------------

    def _spread(self) -> None:
        """Go through the rules until nothing changes."""
        users: Dict[Signature, List[int]] = {}
        for number, rule in enumerate(self.rules):
            for term in rule.atoms:
                users.setdefault(parted(term)[0], []).append(number)
        waiting = dict.fromkeys(range(len(self.rules)))
        while waiting:
            number = next(iter(waiting))
            del waiting[number]
            changed = self._apply(self.rules[number])
            if changed is not None:
                waiting.update(dict.fromkeys(users.get(changed, ())))

    def _apply(self, rule: Rule) -> Optional[Signature]:
        """Add what a rule gives its head; return the head's predicate where there is something new."""
        signature, arguments = parted(rule.head)
        bound = self.bindings(rule) if signature not in self.free else None
        if bound is None:
            return None
        fresh = [self.value(one, rule.parameter, bound) for one in arguments]
        if any(one is not None and not one for one in fresh):
            return None
        tag = next(iter(fresh[0] or ()), None) if signature in self._tagged else None
        rows = self._found.setdefault(signature, {})
        known = rows.get(tag)
        joined = fresh if known is None else _joined([known, fresh])
        if joined == known:
            return None
        rows[tag] = joined
        return signature

    def _row(self, signature: Signature, arguments: Sequence[AST], parameter: str) -> Optional[Row]:
        """Return the values of a predicate's arguments where the first one is as an atom has it; None for no such."""
        rows = self._found[signature]
        if signature not in self._tagged:
            return next(iter(rows.values()))
        alike = [row for tag, row in rows.items() if tag is None or self._match(arguments[0], tag, parameter, {})]
        return _joined(alike) if alike else None

    def _bind(self, term: AST, parameter: str, found: Bindings) -> bool:
        """Narrow ``found`` to what an atom leaves; False where it can't be true."""
        signature, arguments = parted(term)
        if signature in self.free:
            return True
        if signature not in self._found:
            return False
        row = self._row(signature, arguments, parameter)
        return row is not None and all(
            known is None or self._narrow(argument, known, parameter, found) for argument, known in zip(arguments, row)
        )

    def _narrow(self, argument: AST, known: FrozenSet[clingo.Symbol], parameter: str, found: Bindings) -> bool:
        if argument.ast_type == ASTType.Variable:
            return _restrict(found, argument.name, known)
        taken: Dict[str, Set[clingo.Symbol]] = {}
        matched = False
        for symbol in known:
            inside: Dict[str, Set[clingo.Symbol]] = {}
            if self._match(argument, symbol, parameter, inside):
                matched = True
                for name, values in inside.items():
                    taken.setdefault(name, set()).update(values)
        known_names = [name for name, values in taken.items() if WILD not in values]
        return matched and all(_restrict(found, name, frozenset(taken[name])) for name in known_names)

    def _compare(self, literal: AST, parameter: str, found: Bindings) -> bool:
        """Narrow ``found`` to what an equation or inequation leaves; False where that is nothing."""
        if len(literal.atom.guards) != 1:
            return True
        left, guard = literal.atom.term, literal.atom.guards[0]
        for one, other in ((left, guard.term), (guard.term, left)):
            if one.ast_type != ASTType.Variable or one.name == "_":
                continue
            values = self._value(other, parameter, found)
            if values is None:
                continue
            if guard.comparison == ComparisonOperator.Equal:
                return _restrict(found, one.name, values)
            if guard.comparison == ComparisonOperator.NotEqual and len(values) == 1 and one.name in found:
                found[one.name] -= values
                return bool(found[one.name])
        return True

    def _match(self, term: AST, symbol: clingo.Symbol, parameter: str, inside: Dict[str, Set[clingo.Symbol]]) -> bool:
        """Tell whether a term may be ``symbol``; what its variables are then is added to ``inside``."""
        kind = term.ast_type
        if kind == ASTType.Variable:
            inside.setdefault(term.name, set()).add(symbol)
            return True
        if symbol == WILD:
            for name in names_in(term):
                inside.setdefault(name, set()).add(WILD)
            return True
        if kind == ASTType.Function and not term.external:
            if symbol.type != clingo.SymbolType.Function or symbol.name != term.name:
                return False
            arguments = list(zip(term.arguments, symbol.arguments))
            if len(symbol.arguments) != len(term.arguments):
                return False
            return all(self._match(one, value, parameter, inside) for one, value in arguments)
        if kind == ASTType.Pool:
            matches = [self._match(one, symbol, parameter, inside) for one in term.arguments]
            return any(matches)  # each of them tells what its variables are
        if kind == ASTType.SymbolicTerm and parameter and str(term) == parameter:
            return bool(symbol.type == clingo.SymbolType.Number)
        value = evaluate(term, self._constants) if not _mentions(term, parameter) else None
        return value is None or value == symbol

    def _value(self, term: AST, parameter: str, bound: Bindings) -> Values:
        kind = term.ast_type
        if kind == ASTType.Variable:
            return bound.get(term.name)
        if kind == ASTType.Pool:
            return _union(self._value(one, parameter, bound) for one in term.arguments)
        if kind == ASTType.Function and not term.external:
            return self._compound(term, parameter, bound)
        if kind == ASTType.Interval:
            return self._range(term)
        if _mentions(term, parameter):
            return None
        value = evaluate(term, self._constants)
        return None if value is None else frozenset({value})

    def _compound(self, term: AST, parameter: str, bound: Bindings) -> Values:
        rows: List[Tuple[clingo.Symbol, ...]] = [()]
        for one in term.arguments:
            values = self.value(one, parameter, bound)
            values = frozenset({WILD}) if values is None else values
            if len(values) * len(rows) > _MOST:
                return None
            rows = [(*row, value) for row in rows for value in values]
        return frozenset(clingo.Function(term.name, row) for row in rows)

    def _range(self, term: AST) -> Values:
        ends = [evaluate(one, self._constants) for one in (term.left, term.right)]
        numbers = [one.number for one in ends if one is not None and one.type == clingo.SymbolType.Number]
        if len(numbers) < 2 or numbers[1] - numbers[0] > _MOST:
            return None
        return frozenset(clingo.Number(one) for one in range(numbers[0], numbers[1] + 1))


def _rules(statement: AST, parameter: str) -> Iterator[Rule]:
    """Yield what a statement defines or declares."""
    body = list(statement.body) if hasattr(statement, "body") else []
    if statement.ast_type == ASTType.External:
        for term in atom_terms(statement.atom.symbol):
            yield make_rule(parameter, term, body)
    elif statement.ast_type == ASTType.Rule:
        for literal, condition in head_literals(statement.head):
            if literal.sign == Sign.NoSign and literal.atom.ast_type == ASTType.SymbolicAtom:
                for term in atom_terms(literal.atom.symbol):
                    yield make_rule(parameter, term, [*condition, *body])


def make_rule(parameter: str, head: AST, literals: Sequence[AST]) -> Rule:
    """Return the rule of a head with what its body and condition say for certain."""
    plain = [one for one in literals if one.ast_type == ASTType.Literal and one.sign == Sign.NoSign]
    symbols = [one.atom.symbol for one in plain if one.atom.ast_type == ASTType.SymbolicAtom]
    atoms = [one for one in symbols if one.ast_type != ASTType.Pool]
    return Rule(parameter, head, atoms, [one for one in plain if one.atom.ast_type == ASTType.Comparison])


def head_literals(head: AST) -> Iterator[Tuple[AST, Sequence[AST]]]:
    """Yield the literals of a head, each with its condition."""
    if head.ast_type == ASTType.Literal:
        yield head, ()
    elif head.ast_type in (ASTType.Disjunction, ASTType.Aggregate, ASTType.HeadAggregate):
        for element in head.elements:
            one = element.condition if element.ast_type == ASTType.HeadAggregateElement else element
            if one.ast_type == ASTType.ConditionalLiteral:
                yield one.literal, list(one.condition)


def _restrict(found: Bindings, name: str, values: FrozenSet[clingo.Symbol]) -> bool:
    """Let a variable have these values alone; False where none is left."""
    if name != "_":
        found[name] = _common(found[name], values) if name in found else values
        return bool(found[name])
    return bool(values)


def _common(one: FrozenSet[clingo.Symbol], other: FrozenSet[clingo.Symbol]) -> FrozenSet[clingo.Symbol]:
    """Return what both sets may hold; too much where parts of values may be anything."""
    if not any(map(is_open, one)) and not any(map(is_open, other)):
        return one & other
    return frozenset(
        value for mine, its in ((one, other), (other, one)) for value in mine if any(_may_equal(value, x) for x in its)
    )


@lru_cache(maxsize=1 << 12)
def is_open(symbol: clingo.Symbol) -> bool:
    """Tell whether a part of a value may be anything."""
    compound = symbol.type == clingo.SymbolType.Function and symbol.arguments
    return symbol == WILD or bool(compound and any(map(is_open, symbol.arguments)))


def _may_equal(one: clingo.Symbol, other: clingo.Symbol) -> bool:
    if one == other or WILD in (one, other):
        return True
    function = clingo.SymbolType.Function
    if one.type != function or other.type != function or one.name != other.name or one.positive != other.positive:
        return False
    pairs = list(zip(one.arguments, other.arguments))
    return bool(pairs) and len(one.arguments) == len(other.arguments) and all(_may_equal(*pair) for pair in pairs)


def _tagged(rules: Sequence[Rule]) -> Set[Signature]:
    """Return the predicates all of whose heads have a constant as the first of several arguments."""
    found: Dict[Signature, bool] = {}
    for rule in rules:
        signature, arguments = parted(rule.head)
        plain = len(arguments) > 1 and arguments[0].ast_type == ASTType.SymbolicTerm
        tag = plain and str(arguments[0]) != rule.parameter
        found[signature] = tag and found.get(signature, True)
    return {signature for signature, tag in found.items() if tag}


def _joined(rows: Iterable[Row]) -> Row:
    """Return what any of some rows has."""
    found: Row = []
    for row in rows:
        found = [_join(*pair) for pair in zip(found, row)] if found else row
    return found


def _may_hold(known: Values, symbol: clingo.Symbol) -> bool:
    return known is None or bool(_common(known, frozenset({symbol})))


def _join(one: Values, other: Values) -> Values:
    joined = None if one is None or other is None else one | other
    return None if joined is None or len(joined) > _MOST else joined


def _union(parts: Iterable[Values]) -> Values:
    found: FrozenSet[clingo.Symbol] = frozenset()
    for part in parts:
        if part is None:
            return None
        found |= part
    return found


def _mentions(term: AST, parameter: str) -> bool:
    if term.ast_type == ASTType.SymbolicTerm:
        return bool(parameter) and str(term) == parameter
    return any(_mentions(getattr(term, key), parameter) for key in ("left", "right", "argument") if hasattr(term, key))


def _depth(symbol: clingo.Symbol) -> int:
    if symbol.type != clingo.SymbolType.Function or not symbol.arguments:
        return 0
    return 1 + max(map(_depth, symbol.arguments))
