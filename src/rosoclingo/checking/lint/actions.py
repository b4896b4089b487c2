"""The actions that a program can plan, checked against interfaces and labels."""

from typing import (
    AbstractSet,
    Callable,
    Dict,
    FrozenSet,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Set,
    Tuple,
)

import clingo
from clingo.ast import ASTType

from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.action_rules import ACTION
from rosoclingo.oclingo.program.likeness import likely_value, likely_word
from rosoclingo.oclingo.program.nodes import Node, fault_at
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import signature_and_arguments
from rosoclingo.oclingo.program.survey import LABELS
from rosoclingo.oclingo.progression.terms import Signature
from rosoclingo.planning.explaining.atom_patterns import ANY, names_of

LabelQuery = Callable[[clingo.Symbol], Iterable[clingo.Symbol]]
"""Maps the parameter of an action to the terms whose labels its goal needs."""


MANY = 3
"""Least number of other facts with labels in a position from which a missing label is inferred."""


class PlacedName(NamedTuple):
    """A name in a file, with its place."""

    name: str
    file: str
    line: int
    column: int

    def fault(self, kind: str, message: str, remedy: str) -> Fault:
        """Return a fault at this place."""
        return Fault(self.file, self.line, self.column, message, remedy, kind)


class Actions:
    """The actions that a program can plan.

    Attributes:
        all_known: whether ``parameters`` has all actions.
        parameters: the possible parameters by the name of the action as text; None if any term is possible.

    """

    def __init__(self, program: ReactiveProgram) -> None:
        self._survey, values = program.survey, ArgumentValues.of(program)
        self.all_known = bool(values.rules)
        found: Dict[str, Set[clingo.Symbol]] = {}
        self._nodes: Dict[str, Node] = {}
        for number, rule in enumerate(values.rules):
            for atom in values.derived_by(number) if rule.head.signature == ACTION else ():
                name, parameter, _ = atom.arguments
                if names_of(name):
                    self.all_known = False
                else:
                    found.setdefault(str(name), set()).add(parameter)
                    self._nodes.setdefault(str(name), signature_and_arguments(rule.head.term)[1][0])
        self.parameters: Dict[str, Optional[FrozenSet[clingo.Symbol]]] = {
            name: None if ANY in values else frozenset(values) for name, values in found.items()
        }

    def interface_faults(self, interfaces: Sequence[PlacedName]) -> Iterator[Fault]:
        """Yield the actions without an interface, and the interfaces without an action."""
        names = [one.name for one in interfaces]
        for action, node in self._nodes.items():
            if action not in names:
                message = f"no interface executes the action {action}: it is never executed"
                yield fault_at(node, "no-interface", message, likely_value(action, names) if names else "")
        for one in interfaces if self.all_known and self._nodes else ():
            if one.name not in self.parameters:
                message = f"the program has no action {one.name}"
                yield one.fault("idle-interface", message, likely_value(one.name, list(self.parameters)))

    def label_faults(self, labels: Sequence[PlacedName], queries: Mapping[str, LabelQuery]) -> Iterator[Fault]:
        """Yield the places of the program without a label, and the labels that no action uses.

        ``queries`` has the actions that need labels.
        """
        names = {one.name for one in labels}
        needed: Set[str] = set()
        certain = self.all_known
        for action, query in queries.items():
            parameters = self.parameters.get(action, frozenset())
            if parameters is None or any(map(names_of, parameters)):
                certain = False
                continue
            terms = sorted({term for parameter in parameters for term in query(parameter)})
            needed |= set(map(str, terms))
            for term in (one for one in map(str, terms) if one not in names):
                message = f"there is no label {term}: the action {action} will return unknown_label for it"
                remedy = likely_value(term, names) if names else ""
                yield fault_at(self._where(term) or self._nodes[action], "no-label", message, remedy)
        for node in self._odd_in_rows(names):
            if str(node) not in needed:
                message = f"there is no label {node}, although all other facts have labels here"
                yield fault_at(node, "no-label", message, likely_value(str(node), names))
        for one in labels if certain and needed else ():
            if one.name not in needed:
                remedy = likely_word(one.name, needed) or f"places are {', '.join(sorted(needed))}"
                yield one.fault("idle-label", f"no action uses the label {one.name}", remedy)

    def ambiguous_parameters(self, reasons: Callable[[str], AbstractSet[str]]) -> Iterator[Fault]:
        """Yield the parameters that equal a failure reason of their action; ``reasons`` returns these by its name."""
        for action, parameters in self.parameters.items():
            alike = reasons(action) & set(map(str, parameters or ()))
            for term in sorted(alike):
                message = f"{term} is both a parameter and a failure reason of {action}"
                remedy = f"rename it: _return({action},{term},C) would mean success and failure"
                yield fault_at(self._where(term) or self._nodes[action], "like-reason", message, remedy)

    def _odd_in_rows(self, names: Set[str]) -> Iterator[Node]:
        """Yield the only constant without a label in a position where all other facts have labels."""
        rows: Dict[Tuple[Signature, int], Dict[str, Node]] = {}
        for _, statement, found in self._survey.statements:
            if statement.ast_type == ASTType.Rule and not statement.body and all(one.head for one in found):
                for one in found:
                    for position, argument in enumerate(one.arguments):
                        rows.setdefault((one.signature, position), {}).setdefault(str(argument), argument)
        for row in rows.values():
            odd = [node for text, node in row.items() if text not in names]
            if len(odd) == 1 and len(row) > MANY and odd[0].ast_type == ASTType.SymbolicTerm:
                yield odd[0]

    def _where(self, text: str) -> Optional[Node]:
        """Return the occurrence of a term in the fact with the fewest arguments."""
        found: List[Tuple[int, Node]] = []
        for _, statement, atoms in self._survey.statements:
            fact = statement.ast_type == ASTType.Rule and not statement.body and len(atoms) == 1 and atoms[0].head
            for one in atoms[0].term.nodes if fact and statement.location.begin.filename != LABELS else ():
                if one.ast_type in (ASTType.SymbolicTerm, ASTType.Function) and str(one) == text:
                    found.append((len(atoms[0].arguments), one))
        return min(found, key=lambda one: one[0])[1] if found else None

    def likely_queries(self, labels: Sequence[PlacedName]) -> Dict[str, LabelQuery]:
        """Return the actions that probably need labels, as most of their parameters are labels."""
        names = {one.name for one in labels}
        found: Dict[str, LabelQuery] = {}
        for action, parameters in self.parameters.items():
            known = sum(str(one) in names for one in parameters or ())
            if parameters and 2 * known > len(parameters):
                found[action] = lambda parameter: (parameter,)
        return found


def lint_labels(program: ReactiveProgram, labels: Sequence[PlacedName]) -> List[Fault]:
    """Return the faults of labels without knowledge of the interfaces."""
    actions = Actions(program)
    return list(actions.label_faults(labels, actions.likely_queries(labels)))
