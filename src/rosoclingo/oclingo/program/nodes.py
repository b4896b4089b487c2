"""Statements and terms of :mod:`clingo.ast` with cached attributes.

An attribute of clingo's own nodes costs several calls into clingo's library on each access. Analyses read the rules of
a program many times, so a :class:`Node` fetches each attribute once, on first access.
"""

from functools import cached_property
from typing import Any, Callable, List, Optional

from clingo.ast import AST, ASTSequence, ASTType, Location, Position, StrSequence, parse_string

from rosoclingo.oclingo.errors import Fault


class Node:
    """A statement, literal or term with the attributes of its ``AST``: child nodes as ``Node``, sequences as lists.

    Attributes:
        ast: clingo's own node, which must not be modified.
        ast_type: the kind of the node.

    """

    ast: AST
    ast_type: ASTType

    def __init__(self, ast: AST) -> None:
        self.ast = ast
        self.ast_type = ast.ast_type

    def __getattr__(self, name: str) -> Any:
        """Fetch and cache an attribute on first access."""
        if name[:1] == "_":
            raise AttributeError(f"no attribute: {name}")
        value = self.__dict__[name] = _from_ast(getattr(self.ast, name))
        return value

    @cached_property
    def text(self) -> str:
        """The node in clingo's syntax."""
        return str(self.ast)

    @cached_property
    def children(self) -> List["Node"]:
        """The direct child nodes, in order."""
        found: List[Node] = []
        for key in self.ast.child_keys:
            child = getattr(self, key)
            if isinstance(child, Node):
                found.append(child)
            elif child is not None:
                found += child
        return found

    @cached_property
    def nodes(self) -> List["Node"]:
        """The node and all its descendants, in order."""
        found: List[Node] = []
        waiting = [self]
        while waiting:
            found.append(waiting.pop())
            waiting += reversed(found[-1].children)
        return found

    def __str__(self) -> str:
        """Return the node in clingo's syntax."""
        return self.text

    def __eq__(self, other: object) -> bool:
        """Compare like clingo, which ignores locations."""
        return self.ast == other.ast if isinstance(other, Node) else NotImplemented

    def __hash__(self) -> int:
        """Return a hash that ignores locations."""
        return hash(self.ast)

    def update(self, **attributes: Any) -> "Node":
        """Return a copy with new values of some attributes."""
        return Node(self.ast.update(**{name: _to_ast(value) for name, value in attributes.items()}))

    def move(self, place: Callable[[Position], Position]) -> None:
        """Replace the positions of the node and its descendants by ``place`` of them."""
        for one in self.nodes:
            if hasattr(one, "location"):
                begin, end = one.location.begin, one.location.end
                one.ast.location = one.__dict__["location"] = Location(place(begin), place(end))


def _from_ast(value: Any) -> Any:
    if isinstance(value, AST):
        return Node(value)
    return [_from_ast(one) for one in value] if isinstance(value, (ASTSequence, StrSequence)) else value


def _to_ast(value: Any) -> Any:
    if isinstance(value, Node):
        return value.ast
    return [_to_ast(one) for one in value] if isinstance(value, list) else value


def parse(text: str, logger: Optional[Callable[[Any, str], None]] = None) -> List[Node]:
    """Return the statements of a text in clingo's language, after an initial ``#program base.``.

    Raises RuntimeError for invalid texts; details go to the ``logger``.
    """
    found: List[AST] = []
    parse_string(text, found.append, logger=logger)
    return [Node(one) for one in found if one.ast_type != ASTType.Comment]


def fault_at(node: Node, kind: str, message: str, remedy: str) -> Fault:
    """Return a fault at a statement or a term."""
    begin = node.location.begin
    return Fault(begin.filename, begin.line, begin.column, message, remedy, kind)


def make(constructor: Callable[..., AST], *values: Any) -> Node:
    """Return a new node from a constructor of :mod:`clingo.ast` and its arguments."""
    return Node(constructor(*map(_to_ast, values)))
