"""Rules as conditions on atoms and variables, for the analysis of the values that arguments can have."""

from typing import Iterator, List, Mapping, NamedTuple, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType, ComparisonOperator, Sign

from rosoclingo.checking.lint.term_shapes import Shape, shape_of
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import atom_terms, head_literals, parted
from rosoclingo.oclingo.progression.terms import Signature

_Constants = Mapping[str, clingo.Symbol]


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
    """An atom that a statement defines or declares, with its conditions.

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


def rules_of(statement: Node, step: str, constants: _Constants) -> Iterator[Rule]:
    """Yield a rule for each atom that a statement defines or declares."""
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
    """Return the rule of a head with the certain conditions of its body."""
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
