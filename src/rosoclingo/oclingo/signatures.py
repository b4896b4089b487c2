"""What a program's statements mention: signatures, who depends on whom, and where open externals stand.

Works on :mod:`clingo.ast` statements. A *pattern* is an atom as a rule writes it; it tells, without grounding, at
which steps a rule could see a given ground atom.
"""

from typing import Dict, Iterable, Iterator, List, NamedTuple, Optional, Set, Tuple

import clingo
from clingo.ast import AST, ASTType, BinaryOperator, Sign, UnaryOperator


class Signature(NamedTuple):
    """Name, arity and sign (False under classical negation) of a predicate."""

    name: str
    arity: int
    positive: bool = True

    def __str__(self) -> str:
        return "{}{}/{}".format("" if self.positive else "-", self.name, self.arity)


def signature_of(atom: clingo.Symbol) -> Signature:
    """Return the signature of a ground atom."""
    return Signature(atom.name, len(atom.arguments), atom.positive)


class Occurrence(NamedTuple):
    """An atom in a statement: its term, whether it stands in a head, and whether it is a positive body atom."""

    term: AST
    head: bool
    positive: bool

    @property
    def signature(self) -> Signature:
        """The predicate of the atom."""
        return term_signature(self.term)


def term_signature(term: AST) -> Signature:
    """Return the signature of an atom's term."""
    if term.ast_type == ASTType.UnaryOperation:
        return term_signature(term.argument)._replace(positive=False)
    if term.ast_type == ASTType.SymbolicTerm:
        return Signature(term.symbol.name, 0, term.symbol.positive)
    return Signature(term.name, len(term.arguments))


def atom_terms(term: AST) -> Iterator[AST]:
    """Yield the terms of an atom, one for each alternative of a pool."""
    if term.ast_type == ASTType.Pool:
        for argument in term.arguments:
            yield from atom_terms(argument)
    else:
        yield term


def occurrences(statement: AST) -> List[Occurrence]:
    """Return all atoms of ``statement``."""
    found: List[Occurrence] = []
    if statement.ast_type == ASTType.Rule:
        _from_head(statement.head, found)
    elif hasattr(statement, "atom"):
        _from_atom(statement.atom, True, False, found)
    if hasattr(statement, "body"):
        for literal in statement.body:
            _from_body(literal, True, found)
    return found


def _from_atom(atom: AST, head: bool, positive: bool, found: List[Occurrence]) -> None:
    found.extend(Occurrence(term, head, positive) for term in atom_terms(atom.symbol))


def _from_head(head: AST, found: List[Occurrence]) -> None:
    """Collect the atoms of a head: a literal, a disjunction or an aggregate."""
    if head.ast_type == ASTType.Literal:
        if head.atom.ast_type == ASTType.SymbolicAtom:
            _from_atom(head.atom, head.sign == Sign.NoSign, False, found)
        return
    for element in head.elements if hasattr(head, "elements") else ():
        conditional = element.condition if element.ast_type == ASTType.HeadAggregateElement else element
        if conditional.ast_type == ASTType.ConditionalLiteral:
            _from_head(conditional.literal, found)
            for literal in conditional.condition:
                _from_body(literal, True, found)


def _from_body(literal: AST, positive: bool, found: List[Occurrence]) -> None:
    """Collect the atoms of a body literal; in aggregates and conditions those without a sign count as positive."""
    kind = literal.ast_type
    if kind == ASTType.ConditionalLiteral:
        for part in [literal.literal, *list(literal.condition)]:
            _from_body(part, positive, found)
    elif kind == ASTType.Literal:
        atom = literal.atom
        plain = positive and literal.sign == Sign.NoSign
        if atom.ast_type == ASTType.SymbolicAtom:
            _from_atom(atom, False, plain, found)
        elif hasattr(atom, "elements"):
            for element in atom.elements:
                _from_element(element, found)


def _from_element(element: AST, found: List[Occurrence]) -> None:
    if element.ast_type == ASTType.ConditionalLiteral:
        _from_body(element, True, found)
        return
    for literal in element.condition if hasattr(element, "condition") else ():
        _from_body(literal, True, found)


def evaluate(term: AST, values: Dict[str, clingo.Symbol]) -> Optional[clingo.Symbol]:
    """Return the value of a ground term under constants and parameters, None where it has none or is not simple."""
    if term.ast_type == ASTType.SymbolicTerm:
        symbol = term.symbol
        if symbol.type == clingo.SymbolType.Function and not symbol.arguments and symbol.positive:
            return values.get(symbol.name, symbol)
        return symbol
    if term.ast_type == ASTType.UnaryOperation and term.operator_type == UnaryOperator.Minus:
        value = evaluate(term.argument, values)
        return clingo.Number(-value.number) if value is not None and value.type == clingo.SymbolType.Number else None
    if term.ast_type == ASTType.BinaryOperation:
        return _arithmetic(term, evaluate(term.left, values), evaluate(term.right, values))
    return None


def _arithmetic(term: AST, left: Optional[clingo.Symbol], right: Optional[clingo.Symbol]) -> Optional[clingo.Symbol]:
    if left is None or right is None or {left.type, right.type} != {clingo.SymbolType.Number}:
        return None
    a, b = left.number, right.number
    if term.operator_type == BinaryOperator.Plus:
        return clingo.Number(a + b)
    if term.operator_type == BinaryOperator.Minus:
        return clingo.Number(a - b)
    if term.operator_type == BinaryOperator.Multiplication:
        return clingo.Number(a * b)
    if term.operator_type == BinaryOperator.Division and b != 0:
        return clingo.Number(int(a / b))
    return None


class Pattern:
    """An atom as a statement of a program part writes it.

    Attributes:
        term: the atom's term.
        parameter: name of the part's step parameter, empty in base.

    """

    def __init__(self, term: AST, parameter: str) -> None:
        """Take the atom's term and the part's parameter."""
        self.term, self.parameter = term, parameter
        self._offset: Optional[Tuple[int, int]] = None  # the first argument that is t + c, and c
        self._known = False

    def may_match(self, atom: clingo.Symbol, first: int, last: int, constants: Dict[str, clingo.Symbol]) -> bool:
        """Tell whether a ground instance at some step first..last (base: always grounded) could be ``atom``.

        Never wrongly False; variables, intervals and what is hard to evaluate count as a match. The constants have to
        be the same for every call.
        """
        if not self.parameter:
            return _matches(self.term, atom, constants)
        return self.first_match(atom, first, last, constants) is not None

    def first_match(
        self, atom: clingo.Symbol, first: int, last: int, constants: Dict[str, clingo.Symbol]
    ) -> Optional[int]:
        """Return the first step in first..last whose ground instance could be ``atom``, None where there is none."""
        if first > last:
            return None
        pinned = self._pinned_step(atom, constants)
        if pinned is None:
            return first if _matches(self.term, atom, constants, self.parameter) else None
        if not first <= pinned <= last:
            return None
        at_step = dict(constants, **{self.parameter: clingo.Number(pinned)})
        return pinned if _matches(self.term, atom, at_step) else None

    def _pinned_step(self, atom: clingo.Symbol, constants: Dict[str, clingo.Symbol]) -> Optional[int]:
        """Return the one step at which an argument like ``t`` or ``t+1`` fits, None where no argument tells."""
        if not self._known:
            self._offset, self._known = self._find_offset(constants), True
        if self._offset is None:
            return None
        position, offset = self._offset
        value = atom.arguments[position]
        return value.number - offset if value.type == clingo.SymbolType.Number else -(2**31)

    def _find_offset(self, constants: Dict[str, clingo.Symbol]) -> Optional[Tuple[int, int]]:
        arguments = () if self.term.ast_type != ASTType.Function else self.term.arguments
        for position, argument in enumerate(arguments):
            offset = time_offset(argument, self.parameter, constants)
            if offset is not None:
                return position, offset
        return None


def time_offset(term: AST, parameter: str, constants: Dict[str, clingo.Symbol]) -> Optional[int]:
    """Return c where ``term`` is ``parameter + c``, None where it is anything else."""
    values = []
    for step in (0, 1, 5):
        value = evaluate(term, dict(constants, **{parameter: clingo.Number(step)}))
        if value is None or value.type != clingo.SymbolType.Number:
            return None
        values.append(value.number - step)
    return values[0] if len(set(values)) == 1 else None


def _matches(term: AST, symbol: clingo.Symbol, values: Dict[str, clingo.Symbol], parameter: str = "") -> bool:
    """Tell whether ``term`` could be ``symbol``; what holds ``parameter`` could be anything."""
    if term.ast_type == ASTType.UnaryOperation and symbol.type == clingo.SymbolType.Function and not symbol.positive:
        return _matches(term.argument, clingo.Function(symbol.name, symbol.arguments), values, parameter)
    if term.ast_type == ASTType.Function and not term.external:
        if symbol.type != clingo.SymbolType.Function or symbol.name != term.name:
            return False
        pairs = list(zip(term.arguments, symbol.arguments))
        alike = len(term.arguments) == len(symbol.arguments)
        return alike and all(_matches(part, value, values, parameter) for part, value in pairs)
    value = evaluate(term, values)
    return value is None or value == symbol or (parameter != "" and _mentions(term, parameter))


def _mentions(term: AST, name: str) -> bool:
    if term.ast_type == ASTType.BinaryOperation:
        return _mentions(term.left, name) or _mentions(term.right, name)
    if term.ast_type == ASTType.UnaryOperation:
        return _mentions(term.argument, name)
    return bool(term.ast_type == ASTType.SymbolicTerm and str(term) == name)


class Dependencies:
    """Which predicates depend positively on which; edges are added as rules come."""

    def __init__(self) -> None:
        self._users: Dict[Signature, Set[Signature]] = {}

    def copy(self) -> "Dependencies":
        """Return a copy that shares nothing that changes."""
        twin = Dependencies()
        twin._users = {body: set(heads) for body, heads in self._users.items()}
        return twin

    def add(self, heads: Iterable[Signature], bodies: Iterable[Signature]) -> None:
        """Let each of ``heads`` depend on each of ``bodies``."""
        for body in bodies:
            self._users.setdefault(body, set()).update(heads)

    def reaches(self, source: Signature, targets: Set[Signature]) -> bool:
        """Tell whether one of ``targets`` is, or depends through rules on, ``source``."""
        seen, waiting = {source}, [source]
        while waiting:
            signature = waiting.pop()
            if signature in targets:
                return True
            fresh = self._users.get(signature, set()) - seen
            seen |= fresh
            waiting.extend(fresh)
        return False


def rule_edges(statement: AST) -> Tuple[Set[Signature], Set[Signature]]:
    """Return the head signatures and the positive body signatures of a statement."""
    found = occurrences(statement) if statement.ast_type == ASTType.Rule else []
    heads = {one.signature for one in found if one.head}
    return heads, {one.signature for one in found if one.positive}
