"""Why an atom is never true: its rules, what of their bodies is never true either, and so on to where that begins."""

from dataclasses import dataclass
from typing import Dict, Iterator, List, Mapping, Sequence, Tuple

from clingo.ast import ASTType, Sign

from rosoclingo.oclingo.program.domains import plain_literals
from rosoclingo.oclingo.program.lint.rule_shapes import head_literals, parted
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import atom_terms
from rosoclingo.oclingo.progression.terms import Signature, parse_term, signature_of
from rosoclingo.planning.explaining.atom_patterns import (
    Bound,
    Pattern,
    atom_pattern,
    filled,
    fits,
    pattern_of,
    shown,
    signature_in,
)
from rosoclingo.planning.explaining.named_rules import NamedRule, RuleTexts
from rosoclingo.planning.explaining.reach import HeadRule, Reach, UncertainError

Ends = Sequence[Tuple[NamedRule, Mapping[str, str]]]
"""Constraints on the end of a plan, each with the values of its variables."""

_DEEPEST = 6  # rules that are named one after the other
_MANY = 1000  # ways to fill in a body that are looked at


@dataclass(frozen=True)
class NearMiss:
    """A rule that could make an atom true, but never does.

    Attributes:
        file, line, column: where it stands.
        text: the rule.
        atom: the atom, without its time.
        lacks: the atom of its body that is never true, empty where no single one is to blame.

    """

    file: str
    line: int
    column: int
    text: str
    atom: str
    lacks: str


@dataclass(frozen=True)
class NeverTrue:
    """An atom that a plan needs and that is true in none, with any number of steps.

    Attributes:
        atom: the atom, without its time.
        misses: the rules that come nearest to it, what they lack after them; none where no rule has it as its head.

    """

    atom: str
    misses: Tuple[NearMiss, ...] = ()

    def lines(self) -> List[str]:
        """Return it in words."""
        found = [
            f"Nothing ever makes {self.atom} true, with no number of steps{'' if self.misses else ': no rule can'}"
        ]
        for one in self.misses:
            found.append(f"  {one.file}:{one.line}:{one.column}: for {one.atom}")
            found += [f"      {line}" for line in one.text.splitlines()]
            found.append(f"    {_lacks(one)}")
        return found


def _lacks(one: NearMiss) -> str:
    if one.lacks == one.atom:
        return "only hands it on"
    return f"lacks {one.lacks}, which is never true" if one.lacks else "lacks values that fit all of its body"


def never_true(program: ReactiveProgram, reach: Reach, ends: Ends) -> Tuple[NeverTrue, ...]:
    """Return the atoms that the constraints on the end of a plan need, and that are never true."""
    try:
        return tuple(_Search(program, reach).of(ends))
    except UncertainError:
        return ()


class _Search:
    """Looks for rules in what a program can reach."""

    def __init__(self, program: ReactiveProgram, reach: Reach) -> None:
        self._program, self._reach = program, reach
        self._texts = RuleTexts(program.texts)
        self._atoms: Dict[Signature, List[Pattern]] = {}
        for atom in sorted(reach.atoms):
            self._atoms.setdefault(signature_of(atom), []).append(atom_pattern(atom))
        self._rules: Dict[Signature, List[Tuple[HeadRule, Pattern]]] = {}
        for rule in reach.rules:
            head = self._pattern(rule.head)
            self._rules.setdefault(signature_in(head), []).append((rule, head))

    def of(self, ends: Ends) -> Iterator[NeverTrue]:
        """Yield what the ends lack."""
        told: List[Pattern] = []
        for rule, values in ends:
            known: Bound = {name: parse_term(value) for name, value in values.items()}
            for wanted in self._asked(rule, known):
                if wanted not in told and not self._is_possible(wanted):
                    told.append(wanted)
                    yield NeverTrue(self._text(wanted), tuple(self._misses(wanted, [])))

    def _pattern(self, text: str) -> Pattern:
        return pattern_of(text, self._program.values)

    def _text(self, atom: Pattern) -> str:
        signature = signature_in(atom)
        return shown(atom, self._program.time_position(signature.name, signature.arity))

    def _is_possible(self, wanted: Pattern) -> bool:
        return any(fits(wanted, one, {}) for one in self._atoms.get(signature_in(wanted), ()))

    def _asked(self, rule: NamedRule, known: Bound) -> Iterator[Pattern]:
        """Yield the atoms that a constraint asks for, or of which one would end what it forbids."""
        for part, statement in self._statements():
            begin = statement.location.begin
            if (begin.filename, begin.line, begin.column) == (rule.file, rule.line, rule.column):
                negated = list(negated_in(statement))
                yield from (filled(self._pattern(self._reach.written(term, part)), known) for term in negated)
                for literal in () if negated else plain_literals(statement):
                    forbidden = filled(self._pattern(self._reach.written(literal.atom.symbol, part)), known)
                    yield from self._ending(forbidden)

    def _ending(self, atom: Pattern) -> Iterator[Pattern]:
        """Yield the atoms without which an atom is handed on from step to step."""
        for part, statement in self._statements():
            heads = [term for literal, _ in _heads(statement) for term in atom_terms(literal.atom.symbol)]
            bodies = [one.atom.symbol for one in plain_literals(statement)]
            for term in heads if part.parameter else ():
                bound: Bound = {}
                hands_on = any(parted(one)[0] == parted(term)[0] for one in bodies)
                if hands_on and fits(self._pattern(self._reach.written(term, part)), atom, bound):
                    ends = (self._pattern(self._reach.written(one, part)) for one in negated_in(statement))
                    externals = self._program.external_signatures
                    yield from (filled(one, bound) for one in ends if signature_in(one) not in externals)

    def _statements(self) -> Iterator[Tuple[Part, Node]]:
        return ((part, one) for part in self._program.parts for one in part.statements if one.ast_type == ASTType.Rule)

    def _misses(self, atom: Pattern, seen: List[Pattern]) -> Iterator[NearMiss]:
        """Yield the rules for an atom that is never true, each with those for what it lacks after it.

        Rules that only hand it on from the step before are left out where there are others.
        """
        if atom in seen or len(seen) >= _DEEPEST:
            return
        seen.append(atom)
        found = [
            (one, *told)
            for one, head in self._rules.get(signature_in(atom), ())
            for told in self._lack(one, head, atom)
        ]
        others = [one for one in found if one[1] != atom]
        for rule, lacks in others or found:
            begin = rule.statement.location.begin
            text = self._texts.text(rule.statement)
            yield NearMiss(
                begin.filename,
                begin.line,
                begin.column,
                text,
                self._text(atom),
                "" if lacks is None else self._text(lacks),
            )
            if lacks is not None:
                yield from self._misses(lacks, seen)

    def _lack(self, rule: HeadRule, head: Pattern, atom: Pattern) -> Iterator[Tuple[Pattern]]:
        """Yield the first atom of a rule's body that is never true for this head, None where none is to blame."""
        bound: Bound = {}
        if fits(head, atom, bound):
            body = [self._pattern(text) for text in rule.body]
            alone = (filled(one, bound) for one in body if not self._is_possible(filled(one, bound)))
            yield (next(alone, None) or self._lack_together(body, bound),)

    def _lack_together(self, body: Sequence[Pattern], bound: Bound) -> Pattern:
        """Return the first atom that is never true along with those before it, None where there are too many."""
        ways = [bound]
        for one in body:
            longer: List[Bound] = []
            for way in ways:
                for atom in self._atoms.get(signature_in(one), ()):
                    further = dict(way)
                    if fits(one, atom, further):
                        longer.append(further)
            if not longer:
                return filled(one, ways[0])
            if len(longer) > _MANY:
                return None
            ways = longer
        return None


def negated_in(statement: Node) -> Iterator[Node]:
    """Yield the atoms that a rule asks not to be true."""
    literals = [one for one in getattr(statement, "body", ()) if one.ast_type == ASTType.Literal]
    for one in literals:
        if one.sign == Sign.Negation and one.atom.ast_type == ASTType.SymbolicAtom:
            yield from atom_terms(one.atom.symbol)


def _heads(statement: Node) -> Iterator[Tuple[Node, Sequence[Node]]]:
    """Yield the atoms of a rule's head, each with its condition."""
    for literal, condition in head_literals(statement.head):
        if literal.sign == Sign.NoSign and literal.atom.ast_type == ASTType.SymbolicAtom:
            yield literal, condition
