"""Body literals of rules, and the names in terms."""

from typing import Iterator, List

from clingo.ast import ASTType, Sign

from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import atom_terms


def is_plain_atom(literal: Node) -> bool:
    """Return whether a literal is an atom without negation."""
    plain = literal.ast_type == ASTType.Literal and literal.sign == Sign.NoSign
    return bool(plain and literal.atom.ast_type == ASTType.SymbolicAtom)


def plain_literals(statement: Node) -> Iterator[Node]:
    """Yield the positive body literals that consist of a single atom."""
    for literal in statement.body if hasattr(statement, "body") else ():
        if is_plain_atom(literal) and len(list(atom_terms(literal.atom.symbol))) == 1:
            yield literal


def names_in(term: Node) -> List[str]:
    """Return the names of the variables in a term or literal, with repetitions."""
    return [one.name for one in term.nodes if one.ast_type == ASTType.Variable]


def mentions(term: Node, name: str) -> bool:
    """Return whether a constant, such as the step, occurs in a term, literal or statement."""
    return any(one.ast_type == ASTType.SymbolicTerm and str(one) == name for one in term.nodes)
