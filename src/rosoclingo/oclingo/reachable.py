"""Reachability in directed graphs."""

from typing import Callable, Iterable, Set, TypeVar

Node = TypeVar("Node")


def reachable(first: Iterable[Node], successors: Callable[[Node], Iterable[Node]]) -> Set[Node]:
    """Return the ``first`` nodes and all nodes that paths of ``successors`` lead to."""
    found = set(first)
    waiting = list(found)
    while waiting:
        fresh = set(successors(waiting.pop())) - found
        found |= fresh
        waiting += fresh
    return found
