"""What stands below a node of :mod:`clingo.ast`."""

from typing import Any, Dict, Iterator, List, Optional, Tuple

from clingo.ast import AST, ASTSequence, ASTType

#: What nodes of a kind have below them, and whether it is a row; clingo works it out anew for each node.
_KEYS: Dict[ASTType, List[str]] = {}


def children_of(node: AST, kind: Optional[ASTType] = None) -> List[AST]:
    """Return the nodes right below a node, in order; its ``kind`` may be known."""
    kind = kind or node.ast_type
    keys = _KEYS.get(kind)
    if keys is None:
        keys = _KEYS[kind] = node.child_keys
    found: List[AST] = []
    for key in keys:
        child: Any = getattr(node, key)
        if isinstance(child, AST):
            found.append(child)
        elif isinstance(child, ASTSequence):
            found += [one for one in child if isinstance(one, AST)]
    return found


def nodes_of(node: AST) -> Iterator[AST]:
    """Yield a term, literal or statement and all below it."""
    return (one for _, one in kinds_of(node))


def kinds_of(node: AST) -> Iterator[Tuple[ASTType, AST]]:
    """Yield the same, each with its kind, for which clingo takes its time."""
    waiting = [node]
    while waiting:
        one = waiting.pop()
        kind = one.ast_type
        yield kind, one
        waiting += reversed(children_of(one, kind))
