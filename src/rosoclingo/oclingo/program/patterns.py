"""Atoms as rules write them: at which steps a rule could see a given ground atom, told without grounding."""

from typing import Dict, List, Optional, Sequence, Tuple

import clingo
from clingo.ast import AST, ASTType

from rosoclingo.oclingo.program.look_back import longest_look_back, time_offset
from rosoclingo.oclingo.program.signatures import evaluate


class Pattern:
    """An atom as a statement of a program part writes it.

    Attributes:
        term: the atom's term.
        parameter: name of the part's step parameter, empty in base.

    """

    def __init__(self, term: AST, parameter: str, statement: AST) -> None:
        """Take the atom's term, the part's parameter and the statement that the atom stands in."""
        self.term, self.parameter, self._statement = term, parameter, statement
        self._offset: Optional[Tuple[int, int]] = None  # the first argument that is t + c, and c
        self._look_back: List[Tuple[int, int]] = []  # an argument T such that t - T is at most the second number
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
        if not self._known:
            self._offset, self._look_back, self._known = (
                self._find_offset(constants),
                self._find_look_back(constants),
                True,
            )
        last = min([last, *self._last_steps(atom)])
        if first > last:
            return None
        pinned = self._pinned_step(atom)
        if pinned is None:
            return first if _matches(self.term, atom, constants, self.parameter) else None
        if not first <= pinned <= last:
            return None
        at_step = dict(constants, **{self.parameter: clingo.Number(pinned)})
        return pinned if _matches(self.term, atom, at_step) else None

    def _last_steps(self, atom: clingo.Symbol) -> List[int]:
        """Return the steps after which an argument is too old for what the statement compares it to."""
        values = [(atom.arguments[position], bound) for position, bound in self._look_back]
        return [value.number + bound for value, bound in values if value.type == clingo.SymbolType.Number]

    def _pinned_step(self, atom: clingo.Symbol) -> Optional[int]:
        """Return the one step at which an argument like ``t`` or ``t+1`` fits, None where no argument tells."""
        if self._offset is None:
            return None
        position, offset = self._offset
        value = atom.arguments[position]
        return value.number - offset if value.type == clingo.SymbolType.Number else -(2**31)

    def _find_offset(self, constants: Dict[str, clingo.Symbol]) -> Optional[Tuple[int, int]]:
        for position, argument in enumerate(self._arguments()):
            offset = time_offset(argument, self.parameter, constants)
            if offset is not None:
                return position, offset
        return None

    def _find_look_back(self, constants: Dict[str, clingo.Symbol]) -> List[Tuple[int, int]]:
        names = [(number, one.name) for number, one in enumerate(self._arguments()) if one.ast_type == ASTType.Variable]
        bounds = longest_look_back(self._statement, self.parameter, constants) if names else {}
        return [(position, bounds[name]) for position, name in names if name in bounds]

    def _arguments(self) -> Sequence[AST]:
        return self.term.arguments if self.term.ast_type == ASTType.Function else ()


def _matches(term: AST, symbol: clingo.Symbol, values: Dict[str, clingo.Symbol], parameter: str = "") -> bool:
    """Tell whether ``term`` could be ``symbol``; what holds ``parameter`` could be anything."""
    if term.ast_type == ASTType.UnaryOperation and symbol.type == clingo.SymbolType.Function and not symbol.positive:
        return _matches(term.argument, clingo.Function(symbol.name, symbol.arguments), values, parameter)
    if term.ast_type == ASTType.Function and not term.external:
        if symbol.type != clingo.SymbolType.Function or symbol.name != term.name:
            return False
        matching = len(term.arguments) == len(symbol.arguments)
        for part, value in zip(term.arguments, symbol.arguments):
            matching = matching and _matches(part, value, values, parameter)
        return matching
    found = evaluate(term, values)
    return found is None or found == symbol or _mentions(term, parameter)


def _mentions(term: AST, name: str) -> bool:
    if term.ast_type == ASTType.BinaryOperation:
        return _mentions(term.left, name) or _mentions(term.right, name)
    if term.ast_type == ASTType.UnaryOperation:
        return _mentions(term.argument, name)
    return bool(term.ast_type == ASTType.SymbolicTerm and str(term) == name)
