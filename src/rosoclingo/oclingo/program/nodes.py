"""Statements and terms of :mod:`clingo.ast` with cached attributes.

An attribute of clingo's own nodes costs several calls into clingo's library on each access. Analyses read the rules of
a program many times, so a :class:`Node` fetches each attribute once, on first access.
"""

from functools import cached_property
from inspect import signature
from typing import Any, Callable, Dict, FrozenSet, List, Mapping, Optional, Tuple

from clingo.ast import AST, ASTSequence, ASTType, Location, Position, StrSequence, parse_string

#: For each kind, all attributes and the attributes with child nodes; clingo would compute both for each node.
_KEYS: Dict[ASTType, Tuple[FrozenSet[str], List[str]]] = {}

_COMMENTS = (getattr(ASTType, "Comment", None),)  # of clingo 5.7 and later


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
        self.ast_type = kind = ast.ast_type
        keys = _KEYS.get(kind)
        if keys is None:
            keys = _KEYS[kind] = frozenset(ast.keys()), ast.child_keys
        self._keys = keys

    def __getattr__(self, name: str) -> Any:
        """Fetch and cache an attribute on first access."""
        if name[:1] == "_" or name not in self._keys[0]:
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
        for key in self._keys[1]:
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
        """Return a copy with new values of some attributes; it shares the others."""
        twin = Node(self.ast.update(**{name: _to_ast(value) for name, value in attributes.items()}))
        made = {"_keys", "ast", "ast_type", "children", "nodes", "text", *attributes}
        twin.__dict__.update({name: value for name, value in self.__dict__.items() if name not in made})
        twin.__dict__.update(_of_nodes(attributes))
        return twin

    def move(self, place: Callable[[Position], Position]) -> None:
        """Replace the positions of the node and its descendants by ``place`` of them."""
        for one in self.nodes:
            if "location" in one._keys[0]:
                begin, end = one.location.begin, one.location.end
                one.ast.location = one.__dict__["location"] = Location(place(begin), place(end))


def _from_ast(value: Any) -> Any:
    if isinstance(value, AST):
        return Node(value)
    return [_from_ast(one) for one in value] if isinstance(value, (ASTSequence, StrSequence)) else value


def _of_nodes(attributes: Mapping[str, Any]) -> Dict[str, Any]:
    """Return the attributes whose values are nodes, so that the copy shares their caches."""
    given = {name: value if isinstance(value, list) else [value] for name, value in attributes.items()}
    return {name: attributes[name] for name, row in given.items() if all(isinstance(one, Node) for one in row)}


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
    return [Node(one) for one in found if one.ast_type not in _COMMENTS]


def make(constructor: Callable[..., AST], *values: Any) -> Node:
    """Return a new node from a constructor of :mod:`clingo.ast` and its arguments."""
    made = Node(constructor(*map(_to_ast, values)))
    made.__dict__.update(_of_nodes(dict(zip(signature(constructor).parameters, values))))
    return made
