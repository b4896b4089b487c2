"""An over-approximation of the atoms that a program can derive, for any number of steps.

Time arguments are abstracted to one value, and constraints, negation, bounds and aggregates are dropped. So an atom
that the abstract rules do not derive is true in no answer, for any number of steps. Programs that compute with steps,
or whose abstraction has no finite grounding, are not supported.
"""

from typing import FrozenSet, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType, Sign
from clingo.backend import Observer

from rosoclingo.oclingo.program.domains import names_in
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import atom_terms, head_literals, parted
from rosoclingo.oclingo.program.survey import OWN

_MOST = 100_000  # ground rules
_TIME = clingo.Number(0)  # for all times


class UncertainError(Exception):
    """The reachable atoms of the program cannot be computed."""


class HeadRule(NamedTuple):
    """An abstract rule.

    Attributes:
        statement: the rule in the program.
        head: the head atom, as text.
        body: the positive body atoms, as text.
        other: comparisons without times, as text.

    """

    statement: Node
    head: str
    body: Tuple[str, ...]
    other: Tuple[str, ...]

    @property
    def text(self) -> str:
        """The rule as text."""
        return f"{self.head} :- {', '.join([*self.body, *self.other])}." if self.body or self.other else f"{self.head}."


class Reach:
    """The reachable atoms of a program.

    Attributes:
        rules: the abstract rules.
        known: the given atoms.
        atoms: the reachable atoms, without times.

    """

    def __init__(self, program: ReactiveProgram, known: Iterable[clingo.Symbol]) -> None:
        """Compute the atoms that are reachable from ``known`` ones; raises UncertainError."""
        self._program = program
        self.rules: List[HeadRule] = [rule for part in program.parts for rule in self._rules_of(part)]
        constants = "".join(f"#const {name} = {value}.\n" for name, value in program.values.items())
        self.known = [one for one in known if not one.name.startswith(OWN)]
        start = {self._timeless(one) for one in self.known}
        facts = "".join(f"{{ {one} }}.\n" for one in sorted(start))
        self.atoms: FrozenSet[clingo.Symbol] = _closed(constants + facts + "\n".join(one.text for one in self.rules))

    def _timeless(self, atom: clingo.Symbol) -> clingo.Symbol:
        """Return an atom without its time."""
        return atom if self.time_of(atom) is None else self.at(atom, 0)

    def time_of(self, atom: clingo.Symbol) -> Optional[int]:
        """Return the time of an atom, None if it has none."""
        position = self._program.time_position(atom.name, len(atom.arguments))
        time = None if position is None else atom.arguments[position]
        return time.number if time is not None and time.type is clingo.SymbolType.Number else None

    def at(self, atom: clingo.Symbol, time: int) -> clingo.Symbol:
        """Return an atom with another time."""
        position = self._program.time_position(atom.name, len(atom.arguments))
        arguments = [clingo.Number(time) if n == position else one for n, one in enumerate(atom.arguments)]
        return clingo.Function(atom.name, arguments, atom.positive)

    def _rules_of(self, part: Part) -> Iterator[HeadRule]:
        used = self._program.survey.using
        for statement in part.statements:
            if statement.ast_type != ASTType.Rule or statement.location.begin.filename.startswith("<"):
                continue
            for term, condition in positive_heads(statement):
                if parted(term)[0] in used:  # other atoms are in no body
                    yield self._rule(statement, term, [*condition, *statement.body], part)

    def _rule(self, statement: Node, head: Node, literals: Sequence[Node], part: Part) -> HeadRule:
        times: Set[str] = set()
        plain = [one for one in literals if one.ast_type == ASTType.Literal and one.sign == Sign.NoSign]
        atoms = [one.atom.symbol for one in plain if one.atom.ast_type == ASTType.SymbolicAtom]
        texts = tuple(self.text(one, part, times) for one in atoms if not _name(one).startswith(OWN))
        head_text = self.text(head, part, times)
        compared = [one for one in plain if one.atom.ast_type == ASTType.Comparison]
        free = [one for one in compared if not times & set(names_in(one)) and not mentions(one, part.parameter)]
        counted = times & {name for text in (head, *atoms) for name in self._names_outside_time(text)}
        if counted:
            raise UncertainError(f"the rules compute with the time {min(counted)}")
        return HeadRule(statement, head_text, texts, tuple(map(str, free)))

    def _position(self, term: Node) -> Optional[int]:
        signature, arguments = parted(term)
        return self._program.time_position(signature.name, len(arguments)) if arguments else None

    def _names_outside_time(self, term: Node) -> Iterator[str]:
        position = self._position(term)
        for number, one in enumerate(parted(term)[1]):
            if number != position:
                yield from names_in(one)

    def text(self, term: Node, part: Part, times: Optional[Set[str]] = None) -> str:
        """Return the text of a rule's atom without its time, whose variables are added to ``times``.

        Raises UncertainError if the step occurs outside the time.
        """
        if term.ast_type == ASTType.Pool:
            raise UncertainError("an atom is a pool")
        signature, arguments = parted(term)
        position, texts = self._position(term), []
        for number, one in enumerate(arguments):
            if number == position:
                if times is not None:
                    times.update(names_in(one))
                texts.append(str(_TIME))
            elif mentions(one, part.parameter):
                raise UncertainError(f"{signature} has the step in another argument than its time")
            else:
                texts.append(str(one))
        sign = "" if signature.positive else "-"
        return f"{sign}{signature.name}({','.join(texts)})" if texts else f"{sign}{signature.name}"


def positive_heads(statement: Node) -> Iterator[Tuple[Node, Sequence[Node]]]:
    """Yield the positive head atoms of a rule with their conditions."""
    for literal, condition in head_literals(statement.head):
        if literal.sign == Sign.NoSign and literal.atom.ast_type == ASTType.SymbolicAtom:
            yield from ((term, condition) for term in atom_terms(literal.atom.symbol))


def _name(term: Node) -> str:
    """Return the name of an atom."""
    return str(next(parted(one)[0].name for one in atom_terms(term)))


def mentions(node: Node, step: str) -> int:
    """Return how often the step occurs in a statement or term."""
    return sum(one.ast_type == ASTType.SymbolicTerm and str(one) == step for one in node.nodes)


class _TooManyError(Exception):
    """There are more than ``_MOST`` ground rules."""


class _Counter(Observer):
    def __init__(self) -> None:
        self._left = _MOST

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Count a rule."""
        self._left -= 1
        if self._left < 0:
            raise _TooManyError


def _closed(text: str) -> FrozenSet[clingo.Symbol]:
    """Return the atoms that the rules in ``text`` can derive."""
    control = clingo.Control(["-Wnone"], logger=lambda code, message: None)
    control.register_observer(_Counter())
    try:
        control.add("base", [], text)
        control.ground([("base", [])])
    except (RuntimeError, _TooManyError) as error:
        raise UncertainError(str(error)) from None
    return frozenset(one.symbol for one in control.symbolic_atoms)
