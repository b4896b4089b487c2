"""Conditions as bodies of rules: alternatives of literals, which bind their variables."""

from typing import Dict, FrozenSet, Iterable, List, Mapping, NamedTuple, Sequence, Set, Union

from rosoclingo.languages.golog.scanner import GologError, Token
from rosoclingo.languages.golog.tree import (
    Both,
    Comparison,
    Compound,
    Condition,
    Constant,
    Either,
    Holds,
    Member,
    Not,
    Operation,
    Some,
    Term,
    Truth,
    Variable,
)
from rosoclingo.oclingo.errors import Fault

OPPOSITE = {"=": "!=", "!=": "=", "<": ">=", ">=": "<", ">": "<=", "<=": ">"}
MOST = 64
"""So many alternatives may a condition have."""

STEP = "_step"
"""The step in rules, a name that nothing in a control program can have."""

Names = Mapping[str, str]
"""How variables are written: those of inner scopes are given names of their own."""


class Plain(NamedTuple):
    """A literal as text, with the variables that it needs, and those that it binds once it has these."""

    text: str
    needs: FrozenSet[str]
    binds: FrozenSet[str]


class Without(NamedTuple):
    """There are no values with which a condition holds; ``variables`` are those of the scopes around."""

    condition: Condition
    names: Names
    variables: FrozenSet[str]
    token: Token


Literal = Union[Plain, Without]


class Scope:
    """Makes names for variables that are bound within conditions, and knows where faults are."""

    def __init__(self, file: str) -> None:
        self._file, self._count = file, 0
        self._quantified: Set[str] = set()  # what is bound within the present condition
        self.first: Dict[str, Token] = {}  # where each variable stands first

    def begin(self) -> None:
        """A condition begins, whose rules have no variables in common with those before."""
        self._quantified.clear()

    def fault(self, token: Token, message: str, mend: str) -> GologError:
        """Return an error at a word."""
        return GologError(Fault(self._file, token.line, token.column, message, mend))

    def inner(self, names: Names, variables: Iterable[Variable]) -> Dict[str, str]:
        """Return how variables are written where these are bound anew."""
        return self._bind(names, variables, set(names))

    def quantified(self, names: Names, variables: Iterable[Variable]) -> Dict[str, str]:
        """Return the same for variables of ``some``, whose names others of the same condition may have as well."""
        found = self._bind(names, variables, {*names, *self._quantified})
        self._quantified.update(one.token.text for one in variables)
        return found

    def _bind(self, names: Names, variables: Iterable[Variable], taken: Set[str]) -> Dict[str, str]:
        found = dict(names)
        for one in variables:  # no variable of a control program has a ' in it
            self._count += one.token.text in taken
            found[one.token.text] = one.token.text + (f"'{self._count}" if one.token.text in taken else "")
            self.first.setdefault(found[one.token.text], one.token)
        return found

    def term(self, term: Term, names: Names) -> str:
        """Return a term as clingo reads it."""
        if isinstance(term, Variable):
            if term.token.text not in names:
                mend = "name it as a parameter, or by pick, some or all; other names begin with a small letter"
                raise self.fault(term.token, f"nothing says what {term.token.text} is", mend)
            return names[term.token.text]
        if isinstance(term, Constant):
            return term.token.text
        if isinstance(term, Operation):
            left = "" if term.left is None else self._operand(term.left, names)
            return f"{left}{term.token.text}{self._operand(term.right, names)}"
        return term.token.text + (
            f"({','.join(self.term(one, names) for one in term.arguments)})" if term.arguments else ""
        )

    def _operand(self, term: Term, names: Names) -> str:
        text = self.term(term, names)
        return f"({text})" if isinstance(term, Operation) else text


def alternatives(condition: Condition, names: Names, scope: Scope, positive: bool = True) -> List[List[Literal]]:
    """Return in which ways a condition holds, or with ``positive`` False does not hold."""
    if isinstance(condition, Not):
        return alternatives(condition.condition, names, scope, not positive)
    if isinstance(condition, (Both, Either)):
        sides = [alternatives(one, names, scope, positive) for one in (condition.left, condition.right)]
        if isinstance(condition, Both) == positive:
            if len(sides[0]) * len(sides[1]) > MOST:
                raise scope.fault(
                    first_token(condition), f"a condition with more than {MOST} alternatives", "split it up"
                )
            return [[*one, *other] for one in sides[0] for other in sides[1]]
        return [*sides[0], *sides[1]]
    if isinstance(condition, Some):
        if positive:
            return alternatives(condition.condition, scope.quantified(names, condition.variables), scope)
        known = frozenset(names[one] for one in free_variables(condition) if one in names)
        return [[Without(condition, names, known, condition.variables[0].token)]]
    if isinstance(condition, Truth):
        return [[]] if (condition.token.text == "true") == positive else []
    if isinstance(condition, Member) and not positive:
        return alternatives(_outside(condition), names, scope)
    return [[_plain(condition, names, scope, positive)]]


def _plain(condition: Union[Holds, Comparison, Member], names: Names, scope: Scope, positive: bool) -> Plain:
    used = frozenset(names[one] for one in free_variables(condition) if one in names)
    none: FrozenSet[str] = frozenset()
    if isinstance(condition, Holds):
        text = f"golog_holds({scope.term(condition.fluent, names)},{STEP})"
        binds = frozenset(names[one] for one in _arguments_bound(condition.fluent) if one in names)
        return Plain(text, used - binds, binds) if positive else Plain(f"not {text}", used, none)
    if isinstance(condition, Member):
        values, own = [scope.term(one, names) for one in condition.values], scope.term(condition.variable, names)
        text = f"{own}={'..'.join(values)}" if condition.interval else f"{own}=({';'.join(values)})"
        return Plain(text, used - {own}, frozenset([own]))
    operator = condition.operator if positive else OPPOSITE[condition.operator]
    text = f"{scope.term(condition.left, names)}{operator}{scope.term(condition.right, names)}"
    sides = [one for one in (condition.left, condition.right) if isinstance(one, Variable)]
    binds = frozenset(names[one.token.text] for one in sides[:1] if operator == "=")
    return Plain(text, used - binds, binds)


def _outside(member: Member) -> Condition:
    """Return what holds where a variable is none of some values."""
    if member.interval:
        low, high = member.values
        return Either(Comparison(member.variable, "<", low), Comparison(member.variable, ">", high))
    found: Condition = Comparison(member.variable, "!=", member.values[0])
    for value in member.values[1:]:
        found = Both(found, Comparison(member.variable, "!=", value))
    return found


def _arguments_bound(term: Compound) -> Set[str]:
    """Return the variables that stand as arguments, outside of operations."""
    found: Set[str] = set()
    for one in term.arguments:
        if isinstance(one, Variable):
            found.add(one.token.text)
        elif isinstance(one, Compound):
            found |= _arguments_bound(one)
    return found


def free_variables(thing: Union[Condition, Term]) -> Set[str]:
    """Return the variables of a condition or term that nothing in it binds."""
    if isinstance(thing, Variable):
        return {thing.token.text}
    if isinstance(thing, Some):
        return free_variables(thing.condition) - {one.token.text for one in thing.variables}
    return {name for one in _inside(thing) for name in free_variables(one)}


def _inside(thing: Union[Condition, Term]) -> Sequence[Union[Condition, Term]]:
    if isinstance(thing, Compound):
        return thing.arguments
    if isinstance(thing, Holds):
        return thing.fluent.arguments
    if isinstance(thing, Member):
        return [thing.variable, *thing.values]
    if isinstance(thing, Not):
        return [thing.condition]
    if isinstance(thing, Operation):
        return [thing.right] if thing.left is None else [thing.left, thing.right]
    if isinstance(thing, (Both, Either, Comparison)):
        return [thing.left, thing.right]
    return []


def first_token(thing: Union[Condition, Term]) -> Token:
    """Return the word where something begins."""
    if isinstance(thing, Holds):
        return thing.fluent.token
    if isinstance(thing, Member):
        return thing.variable.token
    if isinstance(thing, Some):
        return thing.variables[0].token
    if isinstance(thing, Not):
        return first_token(thing.condition)
    if isinstance(thing, (Both, Either, Comparison)):
        return first_token(thing.left)
    if isinstance(thing, Operation):
        return thing.token if thing.left is None else first_token(thing.left)
    return thing.token


def unbound(literals: Sequence[Literal], known: Iterable[str], wanted: Iterable[str]) -> List[str]:
    """Return which of the ``wanted`` variables and those in the literals nothing binds, given the known ones."""
    bound = set(known)
    plain = [one for one in literals if isinstance(one, Plain)]
    before = -1
    while before != len(bound):
        before = len(bound)
        for one in plain:
            if one.needs <= bound:
                bound |= one.binds
    needed = {name for one in plain for name in one.needs | one.binds} | set(wanted)
    needed |= {name for one in literals if isinstance(one, Without) for name in one.variables}
    return sorted(needed - bound)
