"""Marks that make another statement of what is written: ',' for '.', ':' for ':-', ';' for ':', '.' for ','."""

from typing import Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.lexer import Kind, Token, statements, tokens
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import term_signature
from rosoclingo.oclingo.program.survey import Survey, fault_at, written
from rosoclingo.oclingo.progression.terms import Signature

KIND = "mark"

_DEPTH = {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}


class _Marks(NamedTuple):
    """The marks of a statement that stand in no bracket: those of its head in order, and whether it has a body."""

    head: List[Token]
    has_body: bool


def odd_marks(texts: Iterable[Tuple[str, str]]) -> Iterator[Fault]:
    """Yield the statements of files, names and texts in clingo's language, that a wrong mark makes another one of."""
    for name, text in texts:
        found = tokens(text)
        before = _Marks([], False)
        for first, after in statements(found):
            if found[first].kind not in (Kind.DIRECTIVE, Kind.SCRIPT):
                marks = _marks(found[first:after])
                yield from _odd(name, marks)
                if before.has_body and not marks.has_body and found[first].text == "not":
                    message = "the statement behind this dot begins with not: it forbids what it names at all times"
                    yield _at(name, found[first - 1], message, "is a comma meant?")
                before = marks


def _odd(name: str, marks: _Marks) -> Iterator[Fault]:
    seen = [one.text for one in marks.head]
    if seen and seen[0] == "," and ":" not in seen:
        message = "a comma joins heads into one statement, which says that one of them holds and not which"
        yield _at(name, marks.head[0], message, "is a dot meant? where one of them may hold, write ';'")
    elif seen and seen[0] == ":" and not {";", "|"} & set(seen) and not marks.has_body:
        message = "':' in a head lets one of all for which the condition holds be true; no rule follows from it"
        yield _at(name, marks.head[0], message, "is ':-' meant?")


def _at(name: str, mark: Token, message: str, mend: str) -> Fault:
    return Fault(name, mark.line, mark.column, message, mend, KIND)


def _marks(statement: Sequence[Token]) -> _Marks:
    depth, head = 0, []  # type: int, List[Token]
    for one in statement:
        depth += _DEPTH.get(one.text, 0) if one.kind is Kind.SYMBOL else 0
        if not depth and one.text in (":-", ":~"):
            return _Marks(head, True)
        if not depth and one.kind is Kind.SYMBOL and one.text in (",", ":", ";", "|"):
            head.append(one)
    return _Marks(head, False)


# ---- choices --------------------------------------------------------------------------------------------------------


def odd_choices(survey: Survey) -> Iterator[Fault]:
    """Yield what is chosen freely in a choice though it is given otherwise: it was meant as a condition."""
    chosen = _chosen(survey)
    for _, statement, _ in survey.statements:
        elements = _elements(statement)
        for one in elements[1:]:
            signature = _signature(one)
            alone = (
                not one.condition and signature is not None and not _is_given(survey, _signature(elements[0]), chosen)
            )
            if alone and signature is not None and _is_given(survey, signature, chosen):
                message = f"the choice may make {written(one.literal)} true, of which other statements tell"
                yield fault_at(one.literal, KIND, message, "is it a condition? that stands behind ':' and ','")


def _elements(statement: Node) -> List[Node]:
    """Return the elements of a choice; none of any other statement."""
    is_rule = statement.ast_type == ASTType.Rule
    return list(statement.head.elements) if is_rule and statement.head.ast_type == ASTType.Aggregate else []


def _signature(element: Node) -> Optional[Signature]:
    atom = element.literal.atom
    plain = atom.ast_type == ASTType.SymbolicAtom and atom.symbol.ast_type != ASTType.Pool
    return term_signature(atom.symbol) if plain else None


def _chosen(survey: Survey) -> Dict[Signature, int]:
    """Return in how many choices each predicate stands."""
    found: Dict[Signature, int] = {}
    for _, statement, _ in survey.statements:
        for one in {_signature(element) for element in _elements(statement)} - {None}:
            if one is not None:
                found[one] = found.get(one, 0) + 1
    return found


def _is_given(survey: Survey, signature: Optional[Signature], chosen: Dict[Signature, int]) -> bool:
    """Tell whether a predicate is external, or whether its rules, but for one choice, all say that it holds."""
    if signature is None or chosen.get(signature, 0) > 1:
        return False
    told = [one for one in survey.defining.get(signature, ()) if one.statement.head.ast_type == ASTType.Literal]
    return survey.is_external(signature) or bool(told)
