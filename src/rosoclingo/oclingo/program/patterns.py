"""Atoms as rules write them: at which steps a rule could see a given ground atom, told without grounding."""

from functools import cached_property
from typing import Callable, Dict, Iterator, List, Optional, Sequence, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.look_back import longest_look_back, time_offset
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import evaluate

FAR = 2**31 - 1
"""The greatest number of clingo, so the last step."""

Test = Callable[[clingo.Symbol, Optional[int]], bool]
"""Tells whether a term could be a ground one at a step; None stands for any step."""

Constants = Dict[str, clingo.Symbol]


class Pattern:
    """An atom as a statement of a program part writes it.

    Attributes:
        parameter: name of the part's step parameter, empty in base.

    """

    def __init__(self, term: Node, parameter: str, statement: Node, constants: Constants) -> None:
        """Take the atom's term, the part's parameter, the statement that the atom stands in, and all constants."""
        self.parameter = parameter
        self._term, self._statement, self._constants = term, statement, constants

    def prepare(self) -> None:
        """Work out at once all that is to be known of it; else it is when it is asked for, as most never are."""
        self._matches, self.offsets, self._look_back  # noqa: B018

    @cached_property
    def _matches(self) -> Test:
        return _test(self._term, self.parameter, self._constants)

    @cached_property
    def offsets(self) -> Dict[int, int]:
        """The positions of the arguments that are the parameter plus a number, in order, each with this number."""
        found = {n: time_offset(one, self.parameter, self._constants) for n, one in enumerate(self._arguments())}
        return {position: offset for position, offset in found.items() if offset is not None}

    @cached_property
    def _look_back(self) -> List[Tuple[int, int]]:
        """Arguments T such that t - T is at most the second number."""
        return _look_back(self._arguments(), self.parameter, self._statement, self._constants)

    def _arguments(self) -> Sequence[Node]:
        return self._term.arguments if self._term.ast_type == ASTType.Function else ()

    def may_match(self, atom: clingo.Symbol, first: int, last: int) -> bool:
        """Tell whether a ground instance at some step first..last (base: always grounded) could be ``atom``.

        Never wrongly False; variables, intervals and what is hard to evaluate count as a match.
        """
        if not self.parameter:
            return self._matches(atom, None)
        return self.first_match(atom, first, last) is not None

    def first_match(self, atom: clingo.Symbol, first: int, last: int) -> Optional[int]:
        """Return the first step in first..last whose ground instance could be ``atom``, None where there is none."""
        pinned = self._pinned_step(atom)
        if pinned is not None:
            first, last = max(first, pinned), min(last, pinned)
        last = min([last, *self._last_steps(atom)]) if first <= last else last
        return first if first <= last and self._matches(atom, pinned) else None

    def _last_steps(self, atom: clingo.Symbol) -> List[int]:
        """Return the steps after which an argument is too old for what the statement compares it to."""
        values = [(atom.arguments[position], bound) for position, bound in self._look_back]
        return [value.number + bound for value, bound in values if value.type == clingo.SymbolType.Number]

    def _pinned_step(self, atom: clingo.Symbol) -> Optional[int]:
        """Return the one step at which an argument like ``t`` or ``t+1`` fits, None where no argument tells."""
        if not self.offsets:
            return None
        position, offset = next(iter(self.offsets.items()))
        value = atom.arguments[position]
        return value.number - offset if value.type == clingo.SymbolType.Number else -(2**31)


class Patterns:
    """The patterns of one signature."""

    def __init__(self) -> None:
        self._all: List[Pattern] = []

    def __iter__(self) -> Iterator[Pattern]:
        """Go through the patterns in the program's order."""
        return iter(self._all)

    def append(self, pattern: Pattern) -> None:
        """Add one, before the first question."""
        self._all.append(pattern)

    def may_match(self, atom: clingo.Symbol, first: int, last: int, base: bool = True) -> bool:
        """Tell whether an instance at some step first..last, or of ``base``, could be ``atom``; never wrongly False."""
        for one in self._all:
            if base and not one.parameter and one.may_match(atom, first, last):
                return True
        if self._range is not None:
            # most atoms of a long stream are too old for all of them
            position, least, greatest = self._range
            value = atom.arguments[position]
            if value.type != clingo.SymbolType.Number:
                return False
            first, last = max(first, value.number - greatest), min(last, value.number - least)
        for one in self._all if first <= last else ():
            if one.parameter and one.first_match(atom, first, last) is not None:
                return True
        return False

    @property
    def are_apart(self) -> bool:
        """Whether no two steps have an instance in common."""
        if self._range is None:
            return not any(one.parameter for one in self)
        _, least, greatest = self._range
        return least == greatest

    @cached_property
    def _range(self) -> Optional[Tuple[int, int, int]]:
        """An argument that is the parameter plus a number in all steps' patterns; the least and greatest of these.

        None where there is no such argument.
        """
        offsets = [one.offsets for one in self._all if one.parameter]
        common = set(offsets[0]).intersection(*offsets[1:]) if offsets else set()
        if not common:
            return None
        position = min(common)
        numbers = [one[position] for one in offsets]
        return position, min(numbers), max(numbers)


def _look_back(
    arguments: Sequence[Node], parameter: str, statement: Node, constants: Constants
) -> List[Tuple[int, int]]:
    """Return, for the arguments that are bounded variables, their positions and how far they look back."""
    names = [(number, one.name) for number, one in enumerate(arguments) if one.ast_type == ASTType.Variable]
    bounds = longest_look_back(statement, parameter, constants) if names and parameter else {}
    return [(position, bounds[name]) for position, name in names if name in bounds]


def _test(term: Node, parameter: str, constants: Constants) -> Test:
    """Return the test for ``term``, in a part of this step ``parameter``."""
    if term.ast_type == ASTType.Function and not term.external:
        return _function_test(term, parameter, constants)
    simple = _simple_test(term, parameter, constants)
    if term.ast_type != ASTType.UnaryOperation:
        return simple
    inner = _test(term.argument, parameter, constants)

    def negated(symbol: clingo.Symbol, step: Optional[int]) -> bool:
        """Test a classically negated atom without its sign."""
        if symbol.type == clingo.SymbolType.Function and not symbol.positive:
            return inner(clingo.Function(symbol.name, symbol.arguments), step)
        return simple(symbol, step)

    return negated


def _function_test(term: Node, parameter: str, constants: Constants) -> Test:
    name, tests = term.name, [_test(part, parameter, constants) for part in term.arguments]

    def function(symbol: clingo.Symbol, step: Optional[int]) -> bool:
        """Test name and arguments."""
        if symbol.type != clingo.SymbolType.Function or symbol.name != name or len(symbol.arguments) != len(tests):
            return False
        return all(test(value, step) for test, value in zip(tests, symbol.arguments))

    return function


def _simple_test(term: Node, parameter: str, constants: Constants) -> Test:
    """Return the test for a term that is no function: a value, an offset to the step, or what has a value at a step."""
    if not _mentions(term, parameter):
        value = evaluate(term, constants)
        return lambda symbol, step: value is None or symbol == value
    offset = time_offset(term, parameter, constants)

    def in_time(symbol: clingo.Symbol, step: Optional[int]) -> bool:
        """Test a number that lies at an offset to the step."""
        return step is None or (symbol.type == clingo.SymbolType.Number and symbol.number - (offset or 0) == step)

    def at_step(symbol: clingo.Symbol, step: Optional[int]) -> bool:
        """Test the term's value at the step."""
        if step is None:
            return True
        found = evaluate(term, {**constants, parameter: clingo.Number(step)})
        return found is None or symbol == found

    return at_step if offset is None else in_time


def _mentions(term: Node, name: str) -> bool:
    if term.ast_type == ASTType.BinaryOperation:
        return _mentions(term.left, name) or _mentions(term.right, name)
    if term.ast_type == ASTType.UnaryOperation:
        return _mentions(term.argument, name)
    return bool(term.ast_type == ASTType.SymbolicTerm and str(term) == name)
