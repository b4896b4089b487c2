"""Checks for statements of clingo's incmode, telingo and other drivers, which mean nothing or something else here."""

import re
from typing import Iterable, Iterator, Tuple

from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.lexer import TokenKind, tokens
from rosoclingo.oclingo.program.literals import mentions
from rosoclingo.oclingo.program.nodes import fault_at
from rosoclingo.oclingo.program.survey import Survey, term_text
from rosoclingo.oclingo.program.undefined import QUERY

_INCMODE, _PASSIVE = "incmode", "not-interpreted"

_BOUNDS = {
    "imin": "the core plans as many steps as a goal needs",
    "imax": "the parameter ~horizon_limit, or --imax of oclingo, bounds a plan's steps",
    "istop": "steps are added until there is an answer",
}
_DRIVEN = re.compile(r"[@&]\s*_*[a-z]")
_STATES = ("initial", "final", "tel", "del")


def foreign_statements(survey: Survey, texts: Iterable[Tuple[str, str]]) -> Iterator[Fault]:
    """Yield the statements that only another system interprets; ``texts`` are names and texts of the files."""
    yield from _queries(survey)
    suspicious = any(_DRIVEN.search(text) for _, text in texts)
    for _, statement, _ in survey.statements:
        others = (one for _, one, _ in survey.statements if one is not statement)
        bound = statement.ast_type == ASTType.Definition and statement.name in _BOUNDS
        if bound and not any(mentions(one, statement.name) for one in others):
            message = f"#const {statement.name} has no effect: only clingo's incmode reads it"
            yield fault_at(statement, _INCMODE, message, f"remove it: {_BOUNDS[statement.name]}")
        for node in statement.nodes if suspicious else ():
            if node.ast_type == ASTType.TheoryAtom:
                name = str(node.term).partition("(")[0]
                message = f"&{name} is not interpreted: no theory is loaded, and the atom constrains nothing"
                rules = "rules about atoms with the step" if name in _STATES else "rules, or an aggregate like #sum"
                yield fault_at(node, _PASSIVE, message, f"write {rules}")
            elif node.ast_type == ASTType.Function and node.external:
                message = f"no script defines @{node.name}: clingo drops instances that need it"
                yield fault_at(node, _PASSIVE, message, "state the function's results as facts")


def included_libraries(texts: Iterable[Tuple[str, str]]) -> Iterator[Fault]:
    """Yield each ``#include <NAME>`` in ``texts``, names and texts of files in clingo's language."""
    for name, text in texts:
        found = tokens(text) if "#include" in text else []
        for one, bracket, library in zip(found, found[1:], found[2:]):
            if one.kind is TokenKind.DIRECTIVE and one.text == "#include" and bracket.text == "<":
                message = f"#include <{library.text}> has no effect: rosoclingo adds the steps itself"
                yield Fault(name, one.line, one.column, message, "remove it", _PASSIVE)


def _queries(survey: Survey) -> Iterator[Fault]:
    """Yield the declaration of incmode's external ``query(t)`` if rules use it."""
    if QUERY in survey.defining or QUERY in survey.opened:
        return
    declared, asked = (
        [one for one in places if one.offsets.get(0) == 0]
        for places in (survey.declaring.get(QUERY, ()), survey.using.get(QUERY, ()))
    )
    for place in declared[:1] if asked else ():
        atom = term_text(place.term)
        message = f"{atom} is never true: only clingo's incmode sets it at a plan's last step"
        yield place.fault(_INCMODE, message, f"write the rules into volatile({place.part.parameter}) without {atom}")
