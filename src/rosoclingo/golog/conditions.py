"""Translation of conditions into rule bodies: alternatives of literals that bind their variables."""

from itertools import chain, product
from typing import Dict, FrozenSet, Iterable, List, Mapping, NamedTuple, Sequence, Set, Union

from rosoclingo.golog.grammar import parameters
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.grammars import SyntaxNode, Token

_OPPOSITE = {"=": "!=", "!=": "=", "<": ">=", ">=": "<", ">": "<=", "<=": ">"}
MOST = 64
"""Maximum number of alternatives of a condition."""

STEP = "_step"
"""The step parameter of rules; control programs cannot contain this name."""

Names = Mapping[str, str]
"""The names in rules of the variables in scope; variables of inner scopes are renamed if necessary."""


class GologError(Exception):
    """An error in a control program; ``fault`` has its place and a fix."""

    def __init__(self, fault: Fault) -> None:
        self.fault = fault
        super().__init__(str(fault))


class PlainLiteral(NamedTuple):
    """A literal as text, with the variables that it needs and the variables that it then binds."""

    text: str
    needs: FrozenSet[str]
    binds: FrozenSet[str] = frozenset()

    @property
    def variables(self) -> FrozenSet[str]:
        """All variables of the literal."""
        return self.needs | self.binds


class NegatedCondition(NamedTuple):
    """The negation of a condition that has its own variables; ``variables`` are those of the outer scopes."""

    condition: SyntaxNode
    names: Names
    variables: FrozenSet[str]


Literal = Union[PlainLiteral, NegatedCondition]


class Bindings:
    """Names the variables of a file's conditions, and reports faults with their places."""

    def __init__(self, file: str) -> None:
        self._file, self._count = file, 0
        self._quantified: Set[str] = set()  # variables bound in the present condition
        self.first: Dict[str, SyntaxNode] = {}  # first occurrence of each variable

    def begin(self) -> None:
        """Begin a condition; its rules share no variables with those of earlier conditions."""
        self._quantified.clear()

    def fault(self, place: Union[SyntaxNode, Token], message: str, remedy: str) -> GologError:
        """Return an error at a place."""
        return GologError(Fault(self._file, place.line or 1, place.column or 1, message, remedy))

    def inner_scope(
        self, names: Names, variables: Sequence[SyntaxNode], what: str = "variables", quantifies: bool = False
    ) -> Dict[str, str]:
        """Return the names within a scope that binds ``variables``; raise GologError for duplicates.

        The variables of a quantifier (``quantifies``) differ from all others of the condition.
        """
        used = {*names, *(self._quantified if quantifies else ())}
        found, seen = dict(names), set()  # type: Dict[str, str], Set[str]
        for one in variables:  # variables of control programs cannot contain a '
            if one.text in seen:
                raise self.fault(one, f"two {what} {one.text}", "rename one of them")
            seen.add(one.text)
            self._count += one.text in used
            found[one.text] = one.text + (f"'{self._count}" if one.text in used else "")
            self.first.setdefault(found[one.text], one)
        if quantifies:
            self._quantified |= seen
        return found

    def term(self, term: SyntaxNode, names: Names) -> str:
        """Return a term in clingo's syntax."""
        kind, parts = term.kind, term.parts
        if kind == "variable":
            found = _name_of(term, names)
            if not found:
                remedy = (
                    "bind it as a parameter, or by pick, some or all; names of constants begin with a lower-case letter"
                )
                raise self.fault(term, f"variable {term.text} is unbound", remedy)
            self.first.setdefault(found, term)
            return found
        if kind == "operation":
            return term.text.join(self._operand(one, names) for one in parts)
        if kind == "negative":
            return "-" + self._operand(parts[0], names)
        if kind not in ("constant", "compound"):
            raise self.fault(term, "expected a term, found a condition", "write a name, a number or a variable")
        return term.text + (f"({','.join(self.term(one, names) for one in parts)})" if parts else "")

    def _operand(self, term: SyntaxNode, names: Names) -> str:
        text = self.term(term, names)
        return f"({text})" if term.kind in ("operation", "negative") else text


def _name_of(variable: SyntaxNode, names: Names) -> str:
    """Return the name of a variable in rules, "" if it is unbound; each _ of a fluent has a unique name."""
    found = names.get(variable.text, "")
    return f"Any'{variable.line}'{variable.column}" if found and variable.text == "_" else found


def alternatives(condition: SyntaxNode, names: Names, scope: Bindings, positive: bool = True) -> List[List[Literal]]:
    """Return the alternatives under which a condition holds, or does not hold if ``positive`` is false."""
    kind, parts = condition.kind, condition.parts
    if kind == "not":
        return alternatives(parts[0], names, scope, not positive)
    if kind in ("and", "or"):
        ways = [alternatives(one, names, scope, positive) for one in parts]
        return _conjunction(condition, ways, scope) if (kind == "and") == positive else list(chain(*ways))
    if kind in ("true", "false"):
        return [[]] if (kind == "true") == positive else []
    if kind in ("some", "all"):
        if positive == (kind == "some"):
            return instances(condition, names, scope)
    elif kind == "member":
        return _member(condition, names, scope, positive)
    elif kind == "comparison":
        operator = condition.text if positive else _OPPOSITE[condition.text]
        return [[_comparison(parts[0], operator, parts[1], names, scope)]]
    elif kind != "compound":
        raise scope.fault(condition, "expected a condition, found a term", "write =, !=, <, <=, > or >= after it")
    elif positive or all(one.text != "_" for one in _variables(condition)):
        return [[_fluent(condition, names, scope, positive)]]
    known = frozenset(names[one] for one in free_variables(condition) if one in names)
    return [[NegatedCondition(condition, names, known)]]


def instances(condition: SyntaxNode, names: Names, scope: Bindings) -> List[List[Literal]]:
    """Return the alternatives under which ``some`` or a fluent has values, or ``all`` a counterexample."""
    if condition.kind == "compound":
        return alternatives(condition, names, scope)
    inner = scope.inner_scope(names, parameters(condition), quantifies=True)
    ways = [alternatives(one, inner, scope, not number) for number, one in enumerate(condition.parts[1:])]
    return _conjunction(condition, ways, scope)


def _conjunction(condition: SyntaxNode, sides: Sequence[List[List[Literal]]], scope: Bindings) -> List[List[Literal]]:
    """Return the combinations of the alternatives of all sides."""
    count = 1
    for side in sides:
        count *= len(side)
        if count > MOST:
            raise scope.fault(condition, f"a condition has more than {MOST} alternatives", "split it")
    return [list(chain(*ways)) for ways in product(*sides)]


def _member(condition: SyntaxNode, names: Names, scope: Bindings, positive: bool) -> List[List[Literal]]:
    variable, values = condition.parts
    if variable.kind != "variable":
        raise scope.fault(variable, "'in' needs a variable on its left side", "write it like X in 1..3")
    if positive:
        own, inside = scope.term(variable, names), [scope.term(one, names) for one in values.parts]
        text = f"{own}={'..'.join(inside)}" if values.kind == "range" else f"{own}=({';'.join(inside)})"
        return [[PlainLiteral(text, _names_in(condition, names) - {own}, frozenset([own]))]]
    if values.kind == "range":
        pairs = zip("<>", values.parts)
        return [[_comparison(variable, operator, one, names, scope)] for operator, one in pairs]
    return [[_comparison(variable, "!=", one, names, scope) for one in values.parts]]


def _comparison(left: SyntaxNode, operator: str, right: SyntaxNode, names: Names, scope: Bindings) -> PlainLiteral:
    text = f"{scope.term(left, names)}{operator}{scope.term(right, names)}"
    used = _names_in(left, names) | _names_in(right, names)
    sides = [one for one in (left, right) if one.kind == "variable"]
    binds = frozenset(_name_of(one, names) for one in sides[:1] if operator == "=")
    return PlainLiteral(text, used - binds, binds)


def _fluent(fluent: SyntaxNode, names: Names, scope: Bindings, positive: bool) -> PlainLiteral:
    own = {**names, "_": "_"}
    text, used = f"golog_holds({scope.term(fluent, own)},{STEP})", _names_in(fluent, own)
    if not positive:
        return PlainLiteral(f"not {text}", used)
    binds = frozenset(_name_of(one, own) for one in _arguments_bound(fluent))
    return PlainLiteral(text, used - binds, binds)


def _arguments_bound(term: SyntaxNode) -> List[SyntaxNode]:
    """Return the variables among the arguments, outside of operations."""
    if term.kind == "compound":
        return [found for one in term.parts for found in _arguments_bound(one)]
    return [term] if term.kind == "variable" else []


def _variables(one: SyntaxNode) -> List[SyntaxNode]:
    return [part for part in one.walk() if part.kind == "variable"]


def _names_in(one: SyntaxNode, names: Names) -> FrozenSet[str]:
    """Return the names in rules of all variables in a term or condition."""
    return frozenset(_name_of(part, names) for part in _variables(one))


def free_variables(thing: SyntaxNode) -> Set[str]:
    """Return the free variables of a condition or term."""
    if thing.kind == "variable":
        return {thing.text}
    found = {name for one in thing.parts for name in free_variables(one)}
    return found - {one.text for one in parameters(thing)} if thing.kind in ("some", "all") else found


def unbound(literals: Sequence[Literal], known: Iterable[str], wanted: Iterable[str]) -> List[str]:
    """Return the unbound variables among ``wanted`` and those of the literals, given the ``known`` ones."""
    bound, before = set(known), -1
    plain = [one for one in literals if isinstance(one, PlainLiteral)]
    while before != len(bound):
        before = len(bound)
        bound |= {name for one in plain if one.needs <= bound for name in one.binds}
    return sorted({name for one in literals for name in one.variables}.union(wanted) - bound)
