"""Delays in cycles between a fact and the first action that it can affect, computed from a program's rules.

A fact of cycle T can affect the actions of the same cycle, as in ``{ _action_lib(go,X,t) } :- not low(t).``. If the
program uses observations from the next cycle on, the fact affects only actions of cycle T+1 and later. Times in rules
have the form ``t + c``. The delay is the length of a shortest path from the predicate over the rules that depend on it.
"""

from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

from clingo.ast import ASTType

from rosoclingo.oclingo.program.action_rules import ACTION, RETURN
from rosoclingo.oclingo.program.look_back import shortest_look_back
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Occurrence, Part
from rosoclingo.oclingo.progression.terms import Signature
from rosoclingo.oclingo.reachable import reachable

#: Smallest distance that is distinguished: all paths that lead this far back end in the past.
_FAR_BACK = -3

_Distances = Dict[Signature, int]
_Edge = Tuple[Signature, Signature, int]  # a body, a head, and the steps between them


class _Timed(NamedTuple):
    """An atom of a rule whose time is variable ``name`` plus ``offset``; without a name, the step plus ``offset``."""

    signature: Signature
    head: bool
    positive: bool
    name: str
    offset: int


class Delays:
    """Computes the delays of predicates from the rules of ``parts``."""

    def __init__(self, parts: Sequence[Part]) -> None:
        self._known: Dict[Signature, int] = {}
        self._timed: Set[Signature] = set()
        self._edges: List[_Edge] = []
        self._constraints: List[List[_Timed]] = []
        self._choices: Set[Signature] = set()
        for part in parts:
            for statement, found in part.found:
                self._add_statement(part, statement, found)
        ends = [edge[:2] for edge in self._edges]  # both have a time if one has
        self._timed = reachable(self._timed, lambda one: (end for edge in ends if one in edge for end in edge))
        after_actions = self._spread(self._sources())
        self._edges += [edge for atoms in self._constraints for edge in _edges_to_actions(atoms, after_actions)]

    def of(self, signature: Signature) -> Optional[int]:
        """Return 0 or 1, the least number of cycles from a fact of the predicate to an action that it affects.

        Return 0 if no rule determines the delay, and None if the last argument is not known to be a cycle.
        """
        if signature in self._timed and signature not in self._known:
            self._known[signature] = min(1, max(0, self._spread({signature: 0}).get(ACTION, 0)))
        return self._known.get(signature)

    def _add_statement(self, part: Part, statement: Node, found: Sequence[Occurrence]) -> None:
        atoms = _timed_atoms(part, statement, found)
        self._timed.update(one.signature for one in atoms if not one.name)
        if statement.ast_type != ASTType.Rule or part.name == "volatile":
            return
        heads = [one for one in atoms if one.head]
        # a rule that waits for the return of an action does not restrict later actions
        awaited = [one[3:] for one in atoms if one.positive and one.signature == RETURN]
        bodies = [one for one in atoms if not one.head and (one.signature == RETURN or one[3:] not in awaited)]
        if statement.head.ast_type in (ASTType.Aggregate, ASTType.HeadAggregate, ASTType.Disjunction):
            self._choices.update(one.signature for one in heads)
        if not any(one.head for one in found):
            self._constraints.append(bodies)
        pairs = ((head, body) for head in heads for body in bodies if head.name == body.name)
        self._edges += [(body.signature, head.signature, head.offset - body.offset) for head, body in pairs]

    def _sources(self) -> _Distances:
        """Return the start distances: 0 for actions, and ``-n`` for choices that decide on actions n cycles later."""
        sources = {ACTION: 0}
        for guess in self._choices:
            ahead = self._spread({guess: 0}).get(ACTION)
            if ahead is not None:
                sources[guess] = min(-ahead, sources.get(guess, 0))
        return sources

    def _spread(self, sources: _Distances) -> _Distances:
        """Return the least distance from ``sources`` to each predicate that depends on them."""
        found = dict(sources)
        changed = True
        while changed:
            changed = False
            for body, head, step in self._edges:
                if body in found:
                    reached = max(found[body] + step, _FAR_BACK)
                    if reached < found.get(head, reached + 1):
                        found[head], changed = reached, True
        return found


def _edges_to_actions(atoms: List[_Timed], after_actions: _Distances) -> Iterator[_Edge]:
    """Yield the dependencies of the last action in a constraint on the atoms of the constraint."""
    for one in atoms:
        same_time = (other for other in atoms if other.name == one.name and other.signature in after_actions)
        acts = [other.offset - after_actions[other.signature] for other in same_time]
        if acts:
            yield one.signature, ACTION, max(acts) - one.offset


def _timed_atoms(part: Part, statement: Node, found: Sequence[Occurrence]) -> List[_Timed]:
    """Return the atoms of a statement whose last argument is a time, each with this time."""
    bounds = shortest_look_back(statement, part.parameter, part.constants) if part.parameter else {}
    timed: List[_Timed] = []
    for one in found:
        arguments = one.arguments if one.signature.positive else ()
        name, offset = "", one.offsets.get(len(arguments) - 1)
        if arguments and arguments[-1].ast_type == ASTType.Variable:
            variable = arguments[-1].name
            name, offset = ("", -bounds[variable]) if variable in bounds else (variable, 0)
        if offset is not None:
            timed.append(_Timed(one.signature, one.head, one.positive, name, offset))
    return timed
