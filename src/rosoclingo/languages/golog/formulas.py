"""How conditions are read."""

from dataclasses import replace
from typing import Callable, List, Tuple

from rosoclingo.languages.golog.reader import Reader
from rosoclingo.languages.golog.scanner import GologError
from rosoclingo.languages.golog.tree import (
    Both,
    Comparison,
    Compound,
    Condition,
    Either,
    Holds,
    Member,
    Not,
    Some,
    Term,
    Truth,
    Variable,
)

COMPARISONS = ("=", "!=", "<", "<=", ">", ">=")
OPERATIONS = ("+", "-", "*", "/", "\\")


def read_condition(reader: Reader) -> Condition:
    """Read a condition: ``or`` binds less than ``and``, that less than ``not``."""
    return reader.nested(
        lambda: _joined(reader, "or", lambda: _joined(reader, "and", lambda: _single(reader), Both), Either)
    )


def read_variables(reader: Reader, kind: str = "variables") -> Tuple[Variable, ...]:
    """Read variables between commas, each another one."""
    found = [_variable(reader)]
    while reader.took(","):
        one = _variable(reader)
        if one.token.text in [other.token.text for other in found]:
            raise reader.fault(one.token, f"two {kind} {one.token.text}", "rename one of them")
        found.append(one)
    return tuple(found)


def _variable(reader: Reader) -> Variable:
    return Variable(reader.take_kind("variable", "a variable", "variables begin with a capital letter"))


def _joined(reader: Reader, word: str, part: Callable[[], Condition], make: Callable[..., Condition]) -> Condition:
    found = part()
    while reader.took(word):
        found = make(found, part())
    return found


def _single(reader: Reader) -> Condition:
    if reader.took("not"):
        return Not(reader.nested(lambda: _single(reader)))
    if reader.sees("some", "all"):
        return reader.nested(lambda: _quantified(reader))
    if reader.sees("true", "false"):
        return Truth(reader.read())
    if reader.sees("("):
        found = reader.attempt(lambda: _bracketed(reader))
        if isinstance(found, GologError):  # perhaps it is a term that is compared
            compared = reader.attempt(lambda: _atom(reader))
            if isinstance(compared, GologError):
                raise found
            return compared
        return found
    return _atom(reader)


def _bracketed(reader: Reader) -> Condition:
    bracket = reader.read()
    found = read_condition(reader)
    reader.take(")", f"for the bracket of line {bracket.line}")
    if reader.sees(*COMPARISONS, *OPERATIONS):
        raise reader.fault(reader.next, f"{reader.next} behind a condition", "compare terms, as in X + 1 < 3")
    return found


def _quantified(reader: Reader) -> Condition:
    every = reader.read().text == "all"
    variables = read_variables(reader)
    reader.take(":", "behind the variables")
    inner = _implication(reader) if every else read_condition(reader)  # as far as it goes
    return Not(Some(variables, inner)) if every else Some(variables, inner)


def _implication(reader: Reader) -> Condition:
    """Read ``c -> d`` and return what contradicts it."""
    condition = read_condition(reader)
    reader.take("->", "in 'all X: condition -> condition'")
    return Both(condition, Not(read_condition(reader)))


def _atom(reader: Reader) -> Condition:
    left = reader.term()
    if reader.sees(*COMPARISONS):
        return Comparison(left, reader.read().text, reader.term())
    if isinstance(left, Variable) and reader.took("in"):
        return read_member(reader, left)
    if isinstance(left, Compound):
        return _closed(left)
    raise reader.fault(reader.next, f"{reader.next} where a comparison belongs", "write =, !=, <, <=, > or >=")


def _closed(fluent: Compound) -> Condition:
    """Return that a fluent holds, for some values of each _ in it."""
    found: List[Variable] = []

    def named(term: Term) -> Term:
        """Return a term with a name for each _ in it."""
        if isinstance(term, Compound):
            return replace(term, arguments=tuple(map(named, term.arguments)))
        if isinstance(term, Variable) and term.token.text == "_":
            found.append(Variable(term.token._replace(text=f"Any'{term.token.line}'{term.token.column}")))
            return found[-1]
        return term

    holds = Holds(replace(fluent, arguments=tuple(map(named, fluent.arguments))))
    return Some(tuple(found), holds) if found else holds


def read_member(reader: Reader, variable: Variable) -> Member:
    """Read what a variable is in: a range, or values in brackets."""
    if not reader.took("{"):
        low = reader.term()
        reader.take("..", "between the ends of a range, as in X in 1..3")
        return Member(variable, (low, reader.term()), True)
    values: List[Term] = [reader.term()]
    while reader.took(","):
        values.append(reader.term())
    reader.take("}", "behind the values")
    return Member(variable, tuple(values), False)
