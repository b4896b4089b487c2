"""How control programs are read, by recursive descent."""

from typing import Callable, Dict, List, Tuple

from rosoclingo.languages.golog.formulas import read_condition, read_member, read_variables
from rosoclingo.languages.golog.reader import Reader
from rosoclingo.languages.golog.scanner import RESERVED, GologError, Token, scan
from rosoclingo.languages.golog.tree import (
    AnyAction,
    Around,
    Branch,
    Check,
    Choosing,
    Condition,
    ControlProgram,
    Loop,
    Not,
    Procedure,
    Sequence,
    Several,
    Statement,
    Step,
    Variable,
)
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.likeness import is_slip

NOTHING = Sequence(())


def parse(text: str, name: str, faults: List[Fault]) -> ControlProgram:
    """Read a control program; what is wrong is added to ``faults``, with at most one of the syntax in a procedure."""
    reader = Reader(scan(text, name, faults), name)
    includes: List[Token] = []
    procedures: List[Procedure] = []
    while reader.next.kind != "end":
        try:
            if reader.took("include"):
                includes.append(reader.take_kind("string", "a file's name", 'write include "FILE";'))
                reader.take(";", "behind include")
            else:
                procedures.append(_procedure(reader))
        except GologError as error:
            faults.append(error.fault)
            while not reader.sees("proc", "include") and reader.next.kind != "end":
                reader.read()
    return ControlProgram(tuple(includes), tuple(procedures))


def _procedure(reader: Reader) -> Procedure:
    if not reader.sees("proc"):
        raise reader.fault(reader.next, f"{reader.next} outside of a procedure", "write proc NAME(X) { ... }")
    reader.read()
    name = reader.take_kind("name", "the procedure's name", "names begin with a small letter")
    parameters: Tuple[Variable, ...] = ()
    if reader.took("("):
        parameters = read_variables(reader, "parameters") if not reader.sees(")") else ()
        reader.take(")", "behind the parameters, which are variables")
    return Procedure(name, parameters, _block(reader, f"the body of {name.text}"))


def _block(reader: Reader, what: str) -> Statement:
    begin = reader.take("{", f"before {what}")
    found: List[Statement] = []
    while not reader.sees("}"):
        if reader.next.kind == "end" or reader.sees("proc"):
            raise reader.fault(begin, f"the bracket for {what} is never closed", "write } where it ends")
        if not reader.took(";"):
            found.append(reader.nested(lambda: _statement(reader)))
    reader.read()
    return found[0] if len(found) == 1 else Sequence(tuple(found))


def _statement(reader: Reader) -> Statement:
    token = reader.next
    if token.kind == "word":
        if token.text in _STATEMENTS:
            return _STATEMENTS[token.text](reader, reader.read())
        raise reader.fault(
            token, f"{token} where a statement belongs", _MENDS.get(token.text, "no action has this name")
        )
    found = Step(reader.compound("a statement", "write an action, or a word like if, while, pick"))
    if not reader.sees(";"):
        _slip(reader, token)
    _semicolon(reader, f"behind {found.what.token.text}")
    return found


def _slip(reader: Reader, token: Token) -> None:
    """Raises GologError where a name with more behind it than a statement has is a slip of a word of the language."""
    meant = next((word for word in sorted(RESERVED) if is_slip(token.text, word)), None)
    if meant and not reader.sees("}", "proc") and reader.next.kind != "end":
        raise reader.fault(token, f"{token} is no word of the language, and no ';' is behind it", f"is {meant} meant?")


def _semicolon(reader: Reader, where: str) -> None:
    if not reader.sees("}", "proc") and reader.next.kind != "end":  # the last one of a block may be left out
        reader.take(";", where)


def _any(reader: Reader, token: Token) -> Statement:
    if reader.took("order"):
        return Several("order", _parts(reader, "and", "a part of any order"))
    _semicolon(reader, "behind any")
    return AnyAction(token)


def _check(reader: Reader, token: Token) -> Statement:
    condition = read_condition(reader)
    _semicolon(reader, f"behind the condition of {token.text}")
    return Check(token, condition)


def _achieve(reader: Reader, token: Token) -> Statement:
    condition = read_condition(reader)
    _semicolon(reader, "behind the condition of achieve")
    return Loop(token, Not(condition), AnyAction(token))


def _if(reader: Reader, token: Token) -> Statement:
    condition = read_condition(reader)
    yes = _block(reader, "what is done if so")
    if not reader.took("else"):
        return Branch(token, condition, yes, NOTHING)
    again = reader.sees("if")
    no = reader.nested(lambda: _if(reader, reader.read())) if again else _block(reader, "what is done else")
    return Branch(token, condition, yes, no)


def _while(reader: Reader, token: Token) -> Statement:
    return Loop(token, read_condition(reader), _block(reader, "the body of while"))


def _pick(reader: Reader, token: Token) -> Statement:
    return _choosing(reader, token, "pick")


def _choosing(reader: Reader, token: Token, kind: str) -> Choosing:
    """Read ``X: condition {...}`` or ``X in values {...}``."""
    begin = reader.next
    variables = read_variables(reader)
    if len(variables) == 1 and reader.sees("in"):
        reader.read()
        condition: Condition = read_member(reader, variables[0])
        if reader.sees("and", "or"):
            raise reader.fault(begin, "'in' with further conditions", "write pick X: X in 1..3 and CONDITION {...}")
    else:
        reader.take(":", "behind the variables, as in pick X: CONDITION {...} or pick X in 1..3 {...}")
        condition = read_condition(reader)
    return Choosing(kind, token, variables, condition, _block(reader, f"the body of {token.text}"))


def _parts(reader: Reader, word: str, what: str) -> Tuple[Statement, ...]:
    found = [_block(reader, what)]
    reader.take(word, f"behind the first {{...}}, for {what}")
    found.append(_block(reader, what))
    while reader.took(word):
        found.append(_block(reader, what))
    return tuple(found)


def _choose(reader: Reader, token: Token) -> Statement:
    return Several("choice", _parts(reader, "or", "an alternative"))


def _interleave(reader: Reader, token: Token) -> Statement:
    return Several("conc", _parts(reader, "with", "a part of interleave"))


def _prefer(reader: Reader, token: Token) -> Statement:
    return Several("prio", _parts(reader, "over", "a part of prefer"))


def _star(reader: Reader, token: Token) -> Statement:
    return Around("star", _block(reader, "the body of star"))


def _search(reader: Reader, token: Token) -> Statement:
    return Around("search", _block(reader, f"the body of {token.text}"))


def _try(reader: Reader, token: Token) -> Statement:
    body = _block(reader, "what is tried")
    reader.take("else", "behind what is tried")
    return Around("try", body, other=_block(reader, "what is done if an action fails"))


def _retry(reader: Reader, token: Token) -> Statement:
    number = reader.take_kind("number", "how often it is tried anew", "write retry 3 {...}")
    return Around("retry", _block(reader, "what is tried"), number=number)


def _do(reader: Reader, token: Token) -> Statement:
    body = _block(reader, "what is done")
    if not reader.sees_words("on", "cancel"):
        raise reader.fault(reader.next, f"{reader.next} where 'on cancel' belongs", "write do {...} on cancel {...}")
    reader.read(), reader.read()
    return Around("undoing", body, other=_block(reader, "what is done when it is cancelled"))


def _interrupts(reader: Reader, token: Token) -> Statement:
    """Read ``interrupts { when ... } until c;``: the first ones go before the later ones, and all before the end."""
    begin = reader.take("{", "before the first when")
    parts: List[Statement] = []
    while reader.sees("when"):
        parts.append(_when(reader, reader.read()))
    if not parts or not reader.sees("}"):
        raise reader.fault(
            reader.next, f"{reader.next} where 'when' belongs, in interrupts", "write when CONDITION {...}"
        )
    reader.read()
    if not reader.sees("until"):
        raise reader.fault(begin, "nothing says when these interrupts end", "write until CONDITION; behind them")
    until = reader.read()
    end = Check(Token("word", "await", until.line, until.column), read_condition(reader))
    _semicolon(reader, "behind the condition of until")
    return Several("prio", (*parts, end))


def _when(reader: Reader, token: Token) -> Statement:
    if reader.next.kind != "variable":
        return _unbound(reader, token)
    found = reader.attempt(lambda: _choosing(reader, token, "every"))
    if not isinstance(found, GologError):
        return found
    compared = reader.attempt(lambda: _unbound(reader, token))  # when N > 3, with a variable from around
    if isinstance(compared, GologError):
        raise found
    return compared


def _unbound(reader: Reader, token: Token) -> Choosing:
    return Choosing("every", token, (), read_condition(reader), _block(reader, "the body of when"))


_STATEMENTS: Dict[str, Callable[[Reader, Token], Statement]] = {
    "any": _any,
    "test": _check,
    "await": _check,
    "achieve": _achieve,
    "if": _if,
    "while": _while,
    "pick": _pick,
    "choose": _choose,
    "interleave": _interleave,
    "prefer": _prefer,
    "star": _star,
    "search": _search,
    "alone": _search,
    "try": _try,
    "retry": _retry,
    "do": _do,
    "interrupts": _interrupts,
}

_MENDS = {
    "else": "it belongs right behind the {...} of if or try",
    "or": "write choose {...} or {...}",
    "and": "write any order {...} and {...}",
    "with": "write interleave {...} with {...}",
    "over": "write prefer {...} over {...}",
    "order": "write any order {...} and {...}",
    "when": "write interrupts { when CONDITION {...} } until CONDITION;",
    "until": "write interrupts { when CONDITION {...} } until CONDITION;",
    "not": "conditions stand behind test, if and while",
    "some": "conditions stand behind test, if and while",
    "all": "conditions stand behind test, if and while",
    "true": "write test true;",
    "false": "write test false;",
}
