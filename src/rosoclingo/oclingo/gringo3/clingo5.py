"""What has to be known about statements that are in clingo 5's language already."""

import contextlib
from typing import List, Tuple

import clingo.ast


def head_signatures(text: str) -> List[Tuple[str, int]]:
    """The signatures of the atoms in the heads of statements, or declared external; clingo stops at a faulty statement.

    Only ASCII goes to clingo: its Python module ends the process when a message cuts another character in two.
    """
    found: List[Tuple[str, int]] = []
    plain = text.encode("ascii", "replace").decode("ascii")
    with contextlib.suppress(RuntimeError):  # clingo will name the fault when the program is loaded
        clingo.ast.parse_string(plain, lambda node: found.extend(_of_statement(node)), logger=lambda *message: None)
    return list(dict.fromkeys(found))


def _of_statement(node: clingo.ast.AST) -> List[Tuple[str, int]]:
    if node.ast_type is clingo.ast.ASTType.Rule:
        return _Atoms().of(node.head)
    return _Atoms().of(node.atom) if node.ast_type is clingo.ast.ASTType.External else []


class _Atoms(clingo.ast.Transformer):
    """Collects the signatures of symbolic atoms outside conditions."""

    def __init__(self) -> None:
        self._found: List[Tuple[str, int]] = []

    def of(self, node: clingo.ast.AST) -> List[Tuple[str, int]]:
        """The signatures of the atoms below a node."""
        self.visit(node)
        return self._found

    def visit_SymbolicAtom(self, node: clingo.ast.AST) -> clingo.ast.AST:
        """Note an atom; ``-p`` is a unary operation on the term ``p``."""
        negative = node.symbol.ast_type is clingo.ast.ASTType.UnaryOperation
        self._note(node.symbol.argument if negative else node.symbol, "-" if negative else "")
        return node

    def visit_ConditionalLiteral(self, node: clingo.ast.AST) -> clingo.ast.AST:
        """Look at the literal, not at its condition."""
        self.visit(node.literal)
        return node

    def _note(self, term: clingo.ast.AST, sign: str) -> None:
        if term.ast_type is clingo.ast.ASTType.Function:
            self._found.append((sign + term.name, len(term.arguments)))
        elif term.ast_type is clingo.ast.ASTType.Pool:
            for alternative in term.arguments:
                self._note(alternative, sign)
        elif term.ast_type is clingo.ast.ASTType.SymbolicTerm:
            self._found.append((sign + term.symbol.name, len(term.symbol.arguments)))
