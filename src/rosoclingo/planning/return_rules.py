"""What returns bear on: for each atom ``_return(A,V,T)`` in a rule, whether the rest of the rule holds.

With a rule ``p(t) :- _return(A,V,t), q(V,t).`` it matters whether such a return is told where ``q(V,t)`` holds, and
only there. That is said, for the returns of success of what is done, by a rule that is ground beside it,

    __oclingo_asks(0,A,V,t) :- _action_lib(A,V,t); q(V,t).

so that an answer itself tells it. Where the rest is about actions of the same cycle, ``__oclingo_acts(0,A,V,t)`` holds
where these are, or are not, done as the rule has it.
"""

from functools import lru_cache
from typing import FrozenSet, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType, Sign

from rosoclingo.oclingo.program.action_rules import ACTION, RETURN
from rosoclingo.oclingo.program.literals import names_in
from rosoclingo.oclingo.program.look_back import time_offset
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.patterns import FAR, Pattern
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import Occurrence, term_signature
from rosoclingo.oclingo.progression.terms import Signature

ASKS, ACTS = "__oclingo_asks", "__oclingo_acts"

Constants = Mapping[str, clingo.Symbol]

_SIMPLE = (ASTType.Variable, ASTType.SymbolicTerm, ASTType.Function, ASTType.UnaryOperation, ASTType.BinaryOperation)


class ReturnRules(NamedTuple):
    """The rules that tell what returns bear on.

    Attributes:
        texts: rules, each with the name of the part that they are for and its parameters.
        number: for so many atoms ``_return(A,V,T)``, which are numbered from 0.
        acting: the numbers of those whose rules are about other actions of the same cycle.

    """

    texts: Tuple[Tuple[str, List[str], str], ...]
    number: int
    acting: FrozenSet[int]


def may_heed(parts: Sequence[Part], constants: Constants, atoms: Iterable[clingo.Symbol]) -> bool:
    """Tell whether the body of some rule, at any step, can have one of ``atoms``; False is certain."""
    wanted = list(atoms)
    return any(
        atom.match(one.signature.name, one.signature.arity)
        and Pattern(one.term, part.parameter, statement, dict(constants)).may_match(atom, -FAR, FAR)
        for part in parts
        for statement, one in part.atoms
        if not one.head
        for atom in wanted
    )


def tells_plainly(program: ReactiveProgram) -> bool:
    """Return whether an answer tells its actions, no returns, and by rules of its own what returns bear on.

    Answers are one plan then, and neither the best nor some of many.
    """
    shows = ACTION in program.shows and RETURN not in program.shows
    return shows and not program.optimizes and return_rules(program) is not None


@lru_cache(maxsize=8)
def return_rules(program: ReactiveProgram) -> Optional[ReturnRules]:
    """Return the rules for a program; None if more than single atoms in the bodies of its rules may ask for returns."""
    parts, constants = program.parts, program.values
    if not _acts_at_its_step(parts, constants):
        return None
    texts: List[Tuple[str, List[str], str]] = []
    acting: Set[int] = set()
    for part in parts:
        for statement, found in part.found:
            if _reaches_further(statement):
                return None
            returns = [one for one in found if one.signature == RETURN]
            if not _asks(statement, returns):
                continue
            place = _place(statement, returns, part.parameter, constants)
            if place is None:
                return None
            asking = _Asking.of(len(texts), statement, place)
            acting.update([asking.number] if asking.acts else [])
            texts.append((part.name, [part.parameter], asking.asks + asking.acts))
    return ReturnRules(tuple(texts), len(texts), frozenset(acting))


def _acts_at_its_step(parts: Sequence[Part], constants: Constants) -> bool:
    """Whether each step has its own actions and those alone."""
    for part in parts:
        for _, one in part.atoms:
            if one.head and one.signature == ACTION and _offset(one.term, part.parameter, constants) != 0:
                return False
    return True


def _offset(term: Node, parameter: str, constants: Constants) -> Optional[int]:
    """Return c where the last argument is the step plus c, None where it is not."""
    return time_offset(term.arguments[-1], parameter, dict(constants)) if parameter else None


def _reaches_further(statement: Node) -> bool:
    """Whether a statement may make something of returns that no rule shows: by a theory, or edges of a graph."""
    atoms = [literal.atom for literal in _body(statement) if literal.ast_type == ASTType.Literal]
    heads = [statement.head] if statement.ast_type == ASTType.Rule else []
    theory = any(one.ast_type == ASTType.TheoryAtom for one in (*atoms, *heads))
    return theory or statement.ast_type == ASTType.Edge


def _asks(statement: Node, returns: Sequence[Occurrence]) -> bool:
    """Whether a statement that bears on answers has returns, but to declare them."""
    declares = statement.ast_type == ASTType.External and all(one.head for one in returns)
    return bool(returns) and not declares and statement.ast_type != ASTType.Heuristic


def _place(statement: Node, returns: Sequence[Occurrence], parameter: str, constants: Constants) -> Optional[int]:
    """Return which literal of a rule's body is its only atom with a return, None where that is not all there is."""
    places = [place for place, literal in enumerate(_body(statement)) if _is_atom(literal, RETURN)]
    if statement.ast_type != ASTType.Rule or not len(places) == len(returns) == 1:
        return None
    arguments = returns[0].term.arguments
    simple = all(_is_simple(one) or str(one) == "_" for one in arguments)
    offset = _offset(returns[0].term, parameter, constants)
    return places[0] if simple and offset is not None and offset <= 0 else None


def _is_simple(term: Node) -> bool:
    return "_" not in names_in(term) and all(node.ast_type in _SIMPLE for node in term.nodes)


def _body(statement: Node) -> Sequence[Node]:
    return statement.body if hasattr(statement, "body") else ()


def _is_atom(literal: Node, signature: Signature) -> bool:
    """Whether a body literal is an atom of that signature, under ``not`` or not."""
    plain = literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.SymbolicAtom
    return (
        plain and literal.atom.symbol.ast_type == ASTType.Function and term_signature(literal.atom.symbol) == signature
    )


class _Asking(NamedTuple):
    """A rule that has a return.

    Attributes:
        number: its number.
        cycle: the return's cycle, as text.
        arguments: all its arguments, as text.
        names: the variables in them.
        rest: the other literals of the body.

    """

    number: int
    cycle: str
    arguments: str
    names: Set[str]
    rest: List[Node]

    @classmethod
    def of(cls, number: int, statement: Node, place: int) -> "_Asking":
        """Take the rule apart whose return is the literal at ``place``; ``_`` gets a name, as a head must have one."""
        body = list(_body(statement))
        told = body.pop(place).atom.symbol
        texts = [str(one) for one in told.arguments]
        named = [f"Any{position}__" if text == "_" else text for position, text in enumerate(texts)]
        return cls(number, texts[-1], ",".join(named), set(names_in(told)), body)

    @property
    def asks(self) -> str:
        """The rule that says where the rest holds."""
        return self._rule(ASKS, self.rest)

    @property
    def acts(self) -> str:
        """The rule that says the same of other actions of the same cycle alone; empty where there are none."""
        actions = [
            one for one in self.rest if _is_atom(one, ACTION) and str(one.atom.symbol.arguments[-1]) == self.cycle
        ]
        bound = self.names.union(*(names_in(one.atom) for one in actions if one.sign == Sign.NoSign))
        others = [*actions, *filter(_is_comparison, self.rest)]
        return self._rule(ACTS, [one for one in others if bound.issuperset(names_in(one.atom))]) if actions else ""

    def _rule(self, name: str, rest: Sequence[Node]) -> str:
        body = [f"{ACTION.name}({self.arguments})", *map(str, rest)]
        return f"{name}({self.number},{self.arguments}) :- {'; '.join(body)}.\n"


def _is_comparison(literal: Node) -> bool:
    return literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.Comparison
