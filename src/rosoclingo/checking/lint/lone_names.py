"""Constants and variables that stand once and look like slips of others."""

from collections import Counter
from typing import Dict, Iterable, Iterator, List, NamedTuple, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.domains import names_in
from rosoclingo.oclingo.program.likeness import asked, is_slip
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.survey import LABELS, Survey, fault_at

_PLAIN = clingo.SymbolType.Function
_DIGITS = "0123456789"

Slot = Tuple[object, int]
"""An argument's place: the predicate, or the name and number of arguments of a term, and the position."""


_COMPARED: Slot = ("comparison", 0)


class _Word(NamedTuple):
    """A constant or a variable in a statement."""

    text: str
    node: Node
    slot: Slot


def odd_words(survey: Survey) -> List[Fault]:
    """Return the constants and variables that stand once in the program and are a letter away from others.

    A constant that is the name of a predicate, too, as in golog_holds(asleep,t) :- asleep(t), is none of them.
    """
    constants, variables, compared = _Words(), _Words(), _Words()
    known = {*survey.constants} | {one.signature.name for _, _, found in survey.statements for one in found}
    for part, statement, found in survey.statements:
        for one in found:
            for word in _words(one.arguments, one.signature):
                if word.node.ast_type == ASTType.Variable:
                    variables.add(word)
                elif word.text not in known and word.text != part.parameter:
                    constants.add(word)
        for word in _compared(statement):
            if word.text not in known and word.text != part.parameter:
                compared.add(word)
    values = [one for one in survey.constants if len(one) > 1]
    return [*_constants(constants, compared), *_for_values(compared, constants, values), *_variables(variables)]


class _Words:
    """Words with their places."""

    def __init__(self) -> None:
        self.count: Counter = Counter()
        self.slots: Dict[str, Set[Slot]] = {}
        self._first: Dict[str, _Word] = {}

    def add(self, word: _Word) -> None:
        """Take one."""
        self.count[word.text] += 1
        self.slots.setdefault(word.text, set()).add(word.slot)
        self._first.setdefault(word.text, word)

    def lonely(self) -> Iterator[_Word]:
        """Yield those that stand once."""
        for text, word in self._first.items():
            if self.count[text] == 1 and word.node.location.begin.filename != LABELS:
                yield word


def _compared(statement: Node) -> Iterator[_Word]:
    """Yield the constants in comparisons."""
    for one in statement.nodes:
        if one.ast_type == ASTType.Comparison:
            for term in (one.term, *(guard.term for guard in one.guards)):
                yield from (word for word in _words_in(term, _COMPARED) if word.node.ast_type != ASTType.Variable)


def _constants(words: _Words, compared: _Words) -> Iterator[Fault]:
    """Yield the constants in atoms that stand once; those that are compared, too, do not."""
    for word in words.lonely():
        near = [one for one in words.count if is_slip(word.text, one) and _may_be_meant(word, one, words)]
        meant = max(near, key=lambda one: words.count[one], default=None)
        if meant is not None and word.text not in compared.count:
            yield fault_at(word.node, "misspelt", f"{word.text} stands nowhere else", asked(meant))


def _for_values(compared: _Words, words: _Words, values: Sequence[str]) -> Iterator[Fault]:
    """Yield those that are compared once, and may be one of the names to which a ``#const`` gives ``values``."""
    for word in compared.lonely():
        meant = next((one for one in values if is_slip(word.text, one)), None)
        if meant is not None and word.text not in words.count:
            yield fault_at(word.node, "misspelt", f"{word.text} stands nowhere else", asked(meant))


def _may_be_meant(word: _Word, other: str, words: _Words) -> bool:
    """Tell whether another word stands more often, or lacks where this one stands and is of a longer row."""
    if words.count[other] > 1:
        return True
    rows = Counter(one.rstrip(_DIGITS) for one in words.count)
    lacks = word.slot not in words.slots[other]
    return lacks and rows[word.text.rstrip(_DIGITS)] <= rows[other.rstrip(_DIGITS)]


def _variables(words: _Words) -> Iterator[Fault]:
    for word in words.lonely():
        near = [
            other
            for other, count in words.count.items()
            if count > 2 and word.slot in words.slots[other] and _is_slip_of_variable(word.text, other)
        ]
        if near:
            meant = max(near, key=lambda one: words.count[one])
            yield fault_at(word.node, "misspelt", f"the variable {word.text} stands nowhere else", asked(meant))


def _is_slip_of_variable(text: str, other: str) -> bool:
    if text.lower() == other.lower():
        return text != other and len(text) > 1
    return is_slip(text, other, shortest=2)


def _words(arguments: Iterable[Node], owner: object) -> Iterator[_Word]:
    """Yield the constants and variables that are arguments of an atom, or in terms that are."""
    for position, argument in enumerate(arguments):
        yield from _words_in(argument, (owner, position))


def _words_in(argument: Node, slot: Slot) -> Iterator[_Word]:
    kind = argument.ast_type
    if kind == ASTType.Variable:
        if argument.name != "_":
            yield _Word(argument.name, argument, slot)
    elif kind == ASTType.SymbolicTerm:
        symbol = argument.symbol
        if symbol.type is _PLAIN and not symbol.arguments and symbol.name:
            yield _Word(symbol.name, argument, slot)
    elif kind == ASTType.Function:
        yield from _words(argument.arguments, (argument.name, len(argument.arguments)))
    elif kind == ASTType.Pool:
        for one in argument.arguments:
            yield from _words_in(one, slot)


def lower_case(survey: Survey) -> Iterator[Fault]:
    """Yield the names that may be variables of their rules, written small."""
    named = [(statement, list(_constants_in(statement))) for _, statement, _ in survey.statements]
    count = Counter(word for _, words in named for word, _ in words)
    for statement, words in named:
        own = Counter(word for word, _ in words)
        for word, node in words:
            if count[word] == own[word] and f"{word[:1].upper()}{word[1:]}" in set(names_in(statement)):
                variable = f"{word[:1].upper()}{word[1:]}"
                message = f"{word} is a name that stands nowhere else, and the rule has a variable {variable}"
                yield fault_at(node, "lower-case", message, asked(variable))


def _constants_in(statement: Node) -> Iterator[Tuple[str, Node]]:
    """Yield the names in a rule that may be anything's."""
    for node in statement.nodes if statement.ast_type == ASTType.Rule else ():
        if node.ast_type == ASTType.SymbolicTerm and node.symbol.type is clingo.SymbolType.Function:
            yield str(node.symbol), node
