"""Patterns of atoms in rules: at which steps an instance can match a ground atom, without grounding."""

from functools import cached_property
from typing import Dict, Iterable, List, Mapping, Optional

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.literals import mentions
from rosoclingo.oclingo.program.look_back import longest_look_back, time_offsets
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import arguments_of, evaluate
from rosoclingo.oclingo.progression.terms import Signature

FAR = 2**31 - 1
"""The largest number of clingo, and thus the last step."""

Constants = Dict[str, clingo.Symbol]


class Pattern:
    """An atom in a statement of a program part, as a pattern for ground atoms.

    Attributes:
        term: the atom's term.
        parameter: the name of the part's step parameter, empty in base.
        statement: the statement of the atom.

    """

    def __init__(self, term: Node, parameter: str, statement: Node, constants: Constants) -> None:
        """Store the atom's term, the part's parameter, the statement of the atom, and all constants."""
        self.term, self.parameter, self.statement, self._constants = term, parameter, statement, constants

    @property
    def arguments(self) -> List[Node]:
        """The atom's arguments."""
        return arguments_of(self.term)

    @cached_property
    def offsets(self) -> Dict[int, int]:
        """The offsets of all arguments that are the parameter plus a number, by position."""
        return time_offsets(self.arguments, self.parameter, self._constants)

    @cached_property
    def _look_back(self) -> Dict[int, int]:
        """The maxima of t - T for arguments T that comparisons bound, by position."""
        names = {n: one.name for n, one in enumerate(self.arguments) if one.ast_type == ASTType.Variable}
        wanted = names and self.parameter
        bounds = longest_look_back(self.statement, self.parameter, self._constants) if wanted else {}
        return {position: bounds[name] for position, name in names.items() if name in bounds}

    def can_match(self, atom: clingo.Symbol, first: int, last: int) -> bool:
        """Return whether an instance at some step first..last, or of base, could be ``atom``.

        False is always correct; variables, intervals and terms without a known value count as a match.
        """
        if not self.parameter:
            return self._fits(self.term, atom, None)
        return self.first_match(atom, first, last) is not None

    def first_match(self, atom: clingo.Symbol, first: int, last: int) -> Optional[int]:
        """Return the first step in first..last whose instance could be ``atom``, None if there is none."""
        step = None
        for position, offset in self.offsets.items():
            value = atom.arguments[position]
            if value.type != clingo.SymbolType.Number:
                return None
            step = value.number - offset
            first, last = max(first, step), min(last, step)
        for position, bound in self._look_back.items():
            value = atom.arguments[position]
            last = min(last, value.number + bound) if value.type == clingo.SymbolType.Number else last
        return first if first <= last and self._fits(self.term, atom, step) else None

    def _fits(self, term: Node, symbol: clingo.Symbol, step: Optional[int]) -> bool:
        """Return whether a term can be a symbol at a step; None stands for any step."""
        is_function = symbol.type == clingo.SymbolType.Function
        if term.ast_type == ASTType.Function and not term.external:
            if not is_function or symbol.name != term.name or len(symbol.arguments) != len(term.arguments):
                return False
            return all(self._fits(one, value, step) for one, value in zip(term.arguments, symbol.arguments))
        if term.ast_type == ASTType.UnaryOperation and is_function and not symbol.positive:
            return self._fits(term.argument, clingo.Function(symbol.name, symbol.arguments), step)
        constants = self._constants
        if self.parameter and mentions(term, self.parameter):
            if step is None:
                return True
            constants = {**constants, self.parameter: clingo.Number(step)}
        value = evaluate(term, constants)
        return value is None or value == symbol


def can_match(patterns: Iterable[Pattern], atom: clingo.Symbol, first: int, last: int, base: bool = True) -> bool:
    """Return whether an instance of a pattern at some step first..last, or of ``base``, could be ``atom``."""
    return any(one.can_match(atom, first, last) for one in patterns if one.parameter or base)


def are_apart(patterns: Iterable[Pattern]) -> bool:
    """Return whether one argument identifies the step, so that no two steps have a common instance."""
    steps: List[Dict[int, int]] = [one.offsets for one in patterns if one.parameter]
    return not steps or any(len({one.get(position) for one in steps}) == 1 for position in steps[0])


def can_see_later(seen: Mapping[Signature, Iterable[Pattern]], defined: Mapping[Signature, Iterable[Pattern]]) -> bool:
    """Return whether a rule of some step could contain an atom that a later step defines or declares.

    False is always correct. In that case steps can be grounded together instead of one by one.
    """
    return any(
        one.parameter
        and other.parameter
        and all(other.offsets[n] > one.offsets[n] for n in {*one.offsets} & {*other.offsets})
        for signature, patterns in defined.items()
        for one in patterns
        for other in seen.get(signature, ())
    )
