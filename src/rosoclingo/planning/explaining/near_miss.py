"""Explanations why an atom is never true: its rules, and the body atoms that are never true either."""

from dataclasses import dataclass
from itertools import islice
from typing import Iterator, List, Mapping, Optional, Sequence, Tuple

import clingo
from clingo.ast import ASTType, Sign

from rosoclingo.oclingo.program.literals import plain_literals
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import atom_terms, term_signature
from rosoclingo.oclingo.progression.terms import parse_term, signature_of
from rosoclingo.planning.explaining.atom_patterns import Bound, format_pattern, matches, substitute
from rosoclingo.planning.explaining.named_rules import NamedRule, RuleTexts
from rosoclingo.planning.explaining.reach import HeadRule, Reach, UncertainError, positive_heads

Ends = Sequence[Tuple[NamedRule, Mapping[str, str]]]
"""Constraints on the end of a plan with the values of their variables."""

_MOST_DEPTH = 6  # greatest length of a chain of rules
_MOST_INSTANCES = 1000  # greatest number of instances of a body


@dataclass(frozen=True)
class NearMiss:
    """A rule that never derives an atom which matches its head.

    Attributes:
        file, line, column: its place.
        text: its text.
        atom: the atom, without its time.
        lacks: the body atom that is never true; empty if no single atom is the cause.

    """

    file: str
    line: int
    column: int
    text: str
    atom: str
    lacks: str

    def lines(self) -> List[str]:
        """Return the rule and its lacking atom as text."""
        why = f"requires {self.lacks}, which is never true" if self.lacks else "no values satisfy its whole body"
        if self.lacks == self.atom:
            why = "only carries it over from the previous step"
        place = f"  {self.file}:{self.line}:{self.column}: for {self.atom}"
        return [place, *(f"      {line}" for line in self.text.splitlines()), f"    {why}"]


@dataclass(frozen=True)
class NeverTrue:
    """An atom that a plan requires and that is never true, for any number of steps.

    Attributes:
        atom: the atom, without its time.
        misses: the rules for the atom, each followed by the rules for its lacking atom; empty if no head matches.

    """

    atom: str
    misses: Tuple[NearMiss, ...] = ()

    def lines(self) -> List[str]:
        """Return the explanation as text lines."""
        end = "" if self.misses else ": no rule derives it"
        first = f"{self.atom} is never true, for any number of steps{end}"
        return [first, *(line for one in self.misses for line in one.lines())]


def never_true(program: ReactiveProgram, reach: Reach, ends: Ends) -> Tuple[NeverTrue, ...]:
    """Return the atoms that constraints on the end of a plan require and that are never true."""
    try:
        return tuple(_Search(program, reach).never_true(ends))
    except UncertainError:
        return ()


class _Search:
    """Searches the rules and the reachable atoms of a program."""

    def __init__(self, program: ReactiveProgram, reach: Reach) -> None:
        self._program, self._reach = program, reach
        self._texts = RuleTexts(program.texts)
        self._rules: List[Tuple[Part, Node]] = [
            (part, one) for part in program.parts for one in part.statements if one.ast_type == ASTType.Rule
        ]

    def never_true(self, ends: Ends) -> Iterator[NeverTrue]:
        """Yield the atoms that ``ends`` require and that are never true."""
        found: List[clingo.Symbol] = []
        for rule, values in ends:
            known: Bound = {name: parse_term(value) for name, value in values.items()}
            for wanted in self._required(rule, known):
                if wanted not in found and not self._reach.is_possible(wanted):
                    found.append(wanted)
                    yield NeverTrue(self._text(wanted), tuple(self._misses(wanted, [])))

    def _text(self, atom: clingo.Symbol) -> str:
        signature = signature_of(atom)
        return format_pattern(atom, self._program.time_position(signature.name, signature.arity))

    def _required(self, rule: NamedRule, known: Bound) -> Iterator[clingo.Symbol]:
        """Yield the atoms that a constraint requires, or that would end the state it forbids."""
        for part, statement in self._rules:
            begin = statement.location.begin
            if (begin.filename, begin.line, begin.column) == (rule.file, rule.line, rule.column):
                negated = list(_negated(statement))
                yield from (substitute(self._reach.pattern(term, part.parameter), known) for term in negated)
                for literal in () if negated else plain_literals(statement):
                    yield from self._ending(substitute(self._reach.pattern(literal.atom.symbol, part.parameter), known))

    def _ending(self, atom: clingo.Symbol) -> Iterator[clingo.Symbol]:
        """Yield the atoms that stop inertia: an atom persists to the next step while they are false."""
        for part, statement in self._rules:
            bodies = {term_signature(one.atom.symbol) for one in plain_literals(statement)}
            for term, _ in positive_heads(statement) if part.parameter else ():
                bound: Bound = {}
                if term_signature(term) in bodies and matches(self._reach.pattern(term, part.parameter), atom, bound):
                    ends = (self._reach.pattern(one, part.parameter) for one in _negated(statement))
                    externals = self._program.external_signatures
                    yield from (substitute(one, bound) for one in ends if signature_of(one) not in externals)

    def _misses(self, atom: clingo.Symbol, seen: List[clingo.Symbol]) -> Iterator[NearMiss]:
        """Yield the rules for an atom that is never true, each followed by the rules for its lacking atom.

        Inertia rules, which only carry the atom over from the previous step, are omitted if there are others.
        """
        if atom in seen or len(seen) >= _MOST_DEPTH:
            return
        seen.append(atom)
        found: List[Tuple[HeadRule, Optional[clingo.Symbol]]] = []
        for rule in self._reach.rules:
            for head in rule.head.patterns if rule.head.signature == signature_of(atom) else ():
                bound: Bound = {}
                if matches(head, atom, bound):
                    found.append((rule, self._lack(rule, bound)))
        others = [one for one in found if one[1] != atom]
        for rule, lacks in others or found:
            begin, text = rule.statement.location.begin, self._texts.text(rule.statement)
            lacking = "" if lacks is None else self._text(lacks)
            yield NearMiss(begin.filename, begin.line, begin.column, text, self._text(atom), lacking)
            if lacks is not None:
                yield from self._misses(lacks, seen)

    def _lack(self, rule: HeadRule, bound: Bound) -> Optional[clingo.Symbol]:
        """Return the first body atom that is never true, alone or along with the atoms before it; None if unknown."""
        body = [one.patterns[0] for one in rule.body if len(one.patterns) == 1]
        for atom in (substitute(one, bound) for one in body):
            if not self._reach.is_possible(atom):
                return atom
        instances = [bound]
        for one in body:
            pairs = ((dict(known), atom) for known in instances for atom in self._reach.atoms(signature_of(one)))
            longer = list(islice((known for known, atom in pairs if matches(one, atom, known)), _MOST_INSTANCES))
            if len(longer) in (0, _MOST_INSTANCES):
                return None if longer else substitute(one, instances[0])
            instances = longer
        return None


def _negated(statement: Node) -> Iterator[Node]:
    """Yield the negated body atoms of a rule."""
    for one in statement.body:
        if one.ast_type == ASTType.Literal and one.sign == Sign.Negation and one.atom.ast_type == ASTType.SymbolicAtom:
            yield from atom_terms(one.atom.symbol)
