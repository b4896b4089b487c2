"""A reactive program whose constraints and bounds of choices can be relaxed by assumptions.

The I-th constraint ``:- BODY.`` gets a head and two selectors, which enforce it at step T or at all steps:

    __oclingo_broken(I,T,(X,Y)) :- BODY.
    :- __oclingo_broken(I,T,V), __oclingo_keep(I,T).
    __oclingo_keep(I,T) :- __oclingo_whole(I).

The selectors are choices: without assumptions on its selectors, a constraint excludes nothing. A choice with bounds,
such as ``L { ELEMENTS } U :- BODY.``, is split into the choice and a constraint for the bounds. clingo-explaid
(``UnsatConstraintComputer``) transforms constraints in the same way.

Facts are removed and the program is regrounded, because facts as choices would no longer simplify the grounding, which
could even become infinite.
"""

from copy import copy
from dataclasses import replace
from typing import AbstractSet, Dict, Iterable, Iterator, List, NamedTuple, Optional, Set, Tuple

import clingo
from clingo.ast import ASTType, BodyAggregate, BodyAggregateElement, Literal, Sign

from rosoclingo.oclingo.program.literals import is_plain_atom, names_in
from rosoclingo.oclingo.program.nodes import Node, make, parse
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import atom_terms, term_signature
from rosoclingo.oclingo.program.survey import shows
from rosoclingo.oclingo.progression.terms import Signature
from rosoclingo.planning.explaining.named_rules import NamedRule, RuleKind, RuleTexts

BROKEN, KEEP, WHOLE = "__oclingo_broken", "__oclingo_keep", "__oclingo_whole"
_BASE, _BROKEN = "base", Signature(BROKEN, 3)
_GUARDS = ("left_guard", "right_guard")

_SELECTORS = """
{{ {keep}({number},{step}) }}.
{keep}({number},{step}) :- {whole}({number}).
:- {broken}({number},{step},V__), {keep}({number},{step}).
"""


class Breach(NamedTuple):
    """A violated instance of a rule: its step, None in base, and the values of its variables."""

    number: int
    step: Optional[int]
    values: Tuple[Tuple[str, str], ...]


class RelaxedProgram(ReactiveProgram):
    """A program with relaxed constraints.

    Attributes:
        rules: the constraints, bounds and facts, by their numbers.

    """

    rules: List[NamedRule]

    @classmethod
    def of(cls, program: ReactiveProgram) -> "RelaxedProgram":
        """Return ``program`` with relaxed constraints."""
        return cls(program.texts, {name: str(value) for name, value in program.constants.items()}, whole=True)

    def without(self, facts: AbstractSet[int]) -> "RelaxedProgram":
        """Return the program without the facts of these numbers."""
        program, removed = copy(self), [statement for number, (_, statement) in self._facts.items() if number in facts]
        program.parts = [
            replace(part, statements=[one for one in part.statements if not any(one is other for other in removed)])
            for part in self.parts
        ]
        return program

    def adapt_parts(self) -> None:
        """Relax the constraints."""
        self.rules = []
        self._facts: Dict[int, Tuple[Signature, Node]] = {}
        texts, names = RuleTexts(self.texts), {one.name for one in self.texts}
        showing = any(shows(statement) for part in self.parts for statement in part.statements)
        self.parts = [self._relax(part, texts, names) for part in self.parts]
        free = "".join(f"{{ {WHOLE}({rule.number}) }}.\n" for rule in self.constraints)
        self.parts[0].statements += _parse(free + (f"#show {BROKEN}/3." if showing else ""))

    @property
    def constraints(self) -> List[NamedRule]:
        """The rules that can be relaxed."""
        return [rule for rule in self.rules if rule.kind is not RuleKind.FACT]

    def facts_behind(self, rules: AbstractSet[int]) -> List[int]:
        """Return the numbers of the base part's facts that the rules depend on."""
        places = {one.place for one in self.rules if one.number in rules}
        found = [(_place(statement), atoms) for part in self.parts for statement, atoms in part.found]
        wanted = {one.signature for place, atoms in found if place in places for one in atoms}
        before: Set[Signature] = set()
        while wanted != before:
            before = set(wanted)
            for _, atoms in found:
                if any(one.head and one.signature in wanted and one.signature != _BROKEN for one in atoms):
                    wanted.update(one.signature for one in atoms)
        return [number for number, (signature, _) in self._facts.items() if signature in wanted]

    def breaches(self, answer: Iterable[clingo.Symbol]) -> List[Breach]:
        """Return the instances of rules that an answer violates, ordered by step."""
        found = []
        for number, step, values in (atom.arguments for atom in answer if atom.match(BROKEN, 3)):
            names = self.rules[number.number].variables
            at = step.number if step.type is clingo.SymbolType.Number else None
            found.append(Breach(number.number, at, tuple(zip(names, map(str, values.arguments)))))
        return sorted(found, key=lambda one: (one.step or 0, one.number, one.values))

    def _relax(self, part: Part, texts: RuleTexts, names: AbstractSet[str]) -> Part:
        relaxed = Part(part.name, part.parameter, part.header, window=part.window)
        selectors: List[str] = []
        for statement in part.statements:
            own = statement.ast_type == ASTType.Rule and statement.location.begin.filename in names
            forbidden, rest = _split(statement) if own else (None, [statement])
            if own and part.name == _BASE and not statement.body and is_plain_atom(statement.head):
                rest = list(self._enter_facts(statement, texts))
            relaxed.statements += rest
            if forbidden is not None:
                kind = RuleKind.VOLATILE if part.window else RuleKind.INTEGRITY
                variables = tuple(sorted(_variables(forbidden, statement.head)))
                number = self._enter(statement, texts, RuleKind.BOUND if rest else kind, variables)
                step = part.parameter or _BASE
                values = ",".join(variables) + ("," if len(variables) == 1 else "")
                head = _parse(f"{BROKEN}({number},{step},({values})).")[0].head
                relaxed.statements.append(statement.update(head=head, body=forbidden))
                selectors.append(_SELECTORS.format(keep=KEEP, whole=WHOLE, broken=BROKEN, number=number, step=step))
        relaxed.statements += _parse("".join(selectors))
        return relaxed

    def _enter(
        self, statement: Node, texts: RuleTexts, kind: RuleKind, variables: Tuple[str, ...] = (), text: str = ""
    ) -> int:
        """Add a rule or fact and return its number."""
        begin, number = statement.location.begin, len(self.rules)
        place = (begin.filename, begin.line, begin.column)
        text, words = text or texts.text(statement), texts.words(statement)
        self.rules.append(NamedRule(number, kind, *place, text, words, variables))
        return number

    def _enter_facts(self, statement: Node, texts: RuleTexts) -> Iterator[Node]:
        """Add the facts of a statement, which can be a pool, and yield them as statements."""
        terms = list(atom_terms(statement.head.atom.symbol))
        for term in terms:
            number = self._enter(statement, texts, RuleKind.FACT, text=f"{term}." if len(terms) > 1 else "")
            atom = statement.head.atom.update(symbol=term)
            fact = statement.update(head=statement.head.update(atom=atom))
            self._facts[number] = term_signature(term), fact
            yield fact


def _parse(text: str) -> List[Node]:
    return parse(text)[1:]  # without "#program base."


def _place(statement: Node) -> str:
    begin = statement.location.begin
    return f"{begin.filename}:{begin.line}:{begin.column}"


def _split(rule: Node) -> Tuple[Optional[List[Node]], List[Node]]:
    """Split a rule into the body of a constraint, None if it excludes nothing, and the remaining rules."""
    head, body = rule.head, list(rule.body)
    if head.ast_type == ASTType.Literal:
        if head.atom.ast_type == ASTType.BooleanConstant:
            return (body, []) if not head.atom.value and head.sign == Sign.NoSign else (None, [rule])
        if head.sign == Sign.NoSign:
            return None, [rule]
        sign = Sign.NoSign if head.sign == Sign.Negation else Sign.Negation
        return [*body, head.update(sign=sign)], []
    if all(getattr(head, name, None) is None for name in _GUARDS):
        return None, [rule]
    counted = make(Literal, rule.location, Sign.Negation, _in_body(head))
    return [*body, counted], [rule.update(head=head.update(left_guard=None, right_guard=None))]


def _in_body(aggregate: Node) -> Node:
    """Return a head aggregate as a body aggregate."""
    if aggregate.ast_type == ASTType.Aggregate:
        return aggregate
    elements = [
        make(BodyAggregateElement, one.terms, [one.condition.literal, *one.condition.condition])
        for one in aggregate.elements
    ]
    guards = aggregate.left_guard, aggregate.right_guard
    return make(BodyAggregate, aggregate.location, guards[0], aggregate.function, elements, guards[1])


def _variables(body: Iterable[Node], head: Node) -> Set[str]:
    """Return the global variables of a body and of a head's bounds; those inside aggregates and conditions are local.

    Anonymous variables are left out.
    """
    atoms = [literal.atom for literal in body if literal.ast_type == ASTType.Literal]
    plain = [atom for atom in atoms if not hasattr(atom, "elements")]
    guards = [getattr(atom, name, None) for atom in (*atoms, head) if atom not in plain for name in _GUARDS]
    names = {name for node in (*plain, *guards) if node is not None for name in names_in(node)}
    return {name for name in names if name != "_" and not name.startswith("Any__")}
