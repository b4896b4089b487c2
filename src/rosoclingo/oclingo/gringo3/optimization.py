"""Translates optimization statements, weak constraints and ``#compute``.

Today's solver puts the tuples of all statements of one priority into one set, so each statement gets a mark of its
own: the file's name and a number.
"""

from typing import Iterator, Sequence

from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.gringo3.grammar import UntranslatableError
from rosoclingo.oclingo.gringo3.rewriter import Domains, Rewriting, domain_atoms
from rosoclingo.oclingo.gringo3.rules import instance, separate
from rosoclingo.oclingo.gringo3.terms import Element, Naming, has_interval, has_pool, show, variables


class OptimizationTranslator:
    """Translates the optimization statements of one file."""

    def __init__(self, rewriting: Rewriting, naming: Naming, file: str) -> None:
        self._rewriting, self._naming, self._file = rewriting, naming, file
        self._weak_constraints = 0

    def optimize(self, statement: SyntaxNode, level: int, step: str, domains: Domains) -> None:
        """Translate in place.

        ``level`` is the number of optimization statements before this one, ``step`` the parameter of its part, if any.
        """
        core = statement.parts[0]
        self._rewriting.put(core.tokens[0], "{")
        self._rewriting.put(core.tokens[-1], "}")
        mark, number = ",".join([f'"{self._file}:{level + 1}"', *([step] if step else [])]), 0
        for node in core.parts:
            added, texts, element = domain_atoms(self._rewriting.tokens_of(node), domains), [], Element.of(node)
            for single in element.singles() if element.terms is None else element.tuples(in_head=False):
                priority = show(single.priority) if single.priority else str(level)
                if single.terms is None:
                    single = single.counted(self._naming)
                    is_set = core.kind == "braces"
                    rest = [instance(single.literal)] if is_set else variables(single.literals)
                    first = single.shown_weight
                else:
                    first, *rest = map(show, single.terms)
                key = mark if core.kind == "braces" else f"{mark},{number}"
                conditions = ", ".join([*map(show, single.literals), *added])
                texts.append(f"{','.join([f'{first}@{priority}', key, *rest])} : {conditions}")
                number += 1
            self._rewriting.put(node, "; ".join(texts))
        separate(self._rewriting, core)

    def weak(self, weak: SyntaxNode, after: int, step: str, names: Sequence[str]) -> None:
        """Write the weight of a weak constraint, whose end is before ``after``; each instance of its body counts."""
        dot = next(token for token in weak.tokens if token == ".")
        shown = {"weight_term": "1", "priority_term": "1"}
        for part in weak.parts:
            if part.kind in shown:
                term, what = part.parts[0], part.kind.split("_")[0]
                if has_pool(term) or has_interval(term):
                    message = f"a pool or an interval as {what} of a weak constraint has no clear meaning"
                    raise UntranslatableError(dot, message)
                shown[part.kind] = show(term)
        self._weak_constraints += 1
        terms = ",".join([f'"{self._file}:~{self._weak_constraints}"', *([step] if step else []), *names])
        text = f". [{shown['weight_term']}@{shown['priority_term']},{terms}]"
        self._rewriting.replace(dot.start_pos or 0, after, text)

    def compute(self, statement: SyntaxNode, domains: Domains) -> None:
        """Replace a ``#compute`` statement by constraints."""
        rules = [rule for node in statement.parts[0].parts for rule in self._constraints(node, domains)]
        self._rewriting.put(statement, " ".join(rules))

    def _constraints(self, node: SyntaxNode, domains: Domains) -> Iterator[str]:
        added = domain_atoms(self._rewriting.tokens_of(node), domains)
        for single in Element.of(node).singles():
            atom = show(single.literal.parts[0])
            wanted = atom if single.literal.children[0] == "not" else "not " + atom
            yield f":- {', '.join([wanted, *map(show, single.conditions), *added])}."
