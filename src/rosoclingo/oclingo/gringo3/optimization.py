"""Translation of optimization statements, weak constraints and ``#compute``.

clingo 5 collects the tuples of all statements with the same priority in one set. A mark from file name and number
therefore distinguishes the tuples of different statements.
"""

from typing import List, Sequence

from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.gringo3.grammar import UntranslatableError
from rosoclingo.oclingo.gringo3.rules import instance
from rosoclingo.oclingo.gringo3.terms import Element, ProgramScope, has_interval, has_pool, show, variables


class OptimizationWriter:
    """Translates the optimization statements of one file."""

    def __init__(self, scope: ProgramScope, file: str) -> None:
        self._scope, self._file = scope, file
        self._weak_constraints = 0

    def optimize(self, statement: SyntaxNode, level: int, step: str) -> str:
        """Return the translation of a statement.

        ``level`` is the number of earlier optimization statements, ``step`` the parameter of its part or "".
        """
        core = statement.parts[0]
        texts: List[str] = []
        mark, is_set = ",".join([f'"{self._file}:{level + 1}"', *([step] if step else [])]), core.kind == "braces"
        for node in core.parts:
            element = Element.of(node)
            for single in element.singles() if element.terms is None else element.tuples(in_head=False):
                priority = show(single.priority) if single.priority else str(level)
                if single.terms is None:
                    single = single.counted(self._scope)
                    rest = [instance(single.literal)] if is_set else variables(single.literals)
                    first = single.shown_weight
                else:
                    first, *rest = map(show, single.terms)
                key = mark if is_set else f"{mark},{len(texts)}"
                conditions = ", ".join([*map(show, single.literals), *self._scope.domains_of(variables([node]))])
                texts.append(f"{','.join([f'{first}@{priority}', key, *rest])} : {conditions}")
        return f"{statement.text} {{ {'; '.join(texts)} }}."

    def weak(self, weak: SyntaxNode, body: str, names: Sequence[str], step: str) -> str:
        """Return the translation of a weak constraint; each instance of its body counts."""
        dot = next(token for token in weak.tokens if token == ".")
        shown = {"weight_term": "1", "priority_term": "1"}
        for part in weak.parts:
            if part.kind in shown:
                term, what = part.parts[0], part.kind.split("_")[0]
                if has_pool(term) or has_interval(term):
                    message = f"a pool or an interval as {what} of a weak constraint is ambiguous"
                    raise UntranslatableError(dot, message)
                shown[part.kind] = show(term)
        self._weak_constraints += 1
        terms = ",".join([f'"{self._file}:~{self._weak_constraints}"', *([step] if step else []), *names])
        return f":~ {body}. [{shown['weight_term']}@{shown['priority_term']},{terms}]"

    def compute(self, statement: SyntaxNode) -> str:
        """Return the constraints that replace a ``#compute`` statement."""
        constraints: List[str] = []
        for node in statement.parts[0].parts:
            domains = self._scope.domains_of(variables([node]))
            for single in Element.of(node).singles():
                atom = show(single.literal.parts[0])
                wanted = atom if single.literal.children[0] == "not" else "not " + atom
                constraints.append(f":- {', '.join([wanted, *map(show, single.conditions), *domains])}.")
        return " ".join(constraints)
