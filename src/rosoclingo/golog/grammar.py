"""The grammar of control programs, and what is wrong with a text that it does not accept."""

import re
from functools import lru_cache
from typing import List, NamedTuple, Optional, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.grammars import Grammar, MisfitError, SyntaxNode, Token
from rosoclingo.oclingo.program.likeness import is_slip

GREATEST = 2**31 - 1
"""The greatest number that clingo knows; of greater ones it would take what is left of some of their bits."""

_GRAMMAR = r"""
include: "include" STRING ";"
procedure: "proc" NAME ("(" variables? ")")? seq
variables: variable ("," variable)*
variable: VARIABLE

?seq: "{" (_long | _short ";" | ";")* _short? "}"
_short: step | any | test | await | achieve | interrupts
_long: if | while | pick | choice | conc | prio | order | star | search | retry | try | undoing
step: compound
any: "any"
test: "test" _condition
await: "await" _condition
achieve: "achieve" _condition
interrupts: "interrupts" "{" every+ "}" until
every: "when" variables ":" _condition seq | "when" _condition seq
until: "until" _condition
if: "if" _condition seq ("else" (if | seq))?
while: "while" _condition seq
pick: "pick" variables ":" _condition seq | "pick" choice_of seq
choice_of: variable "in" _values -> member
choice: "choose" seq ("or" seq)+
conc: "interleave" seq ("with" seq)+
prio: "prefer" seq ("over" seq)+
order: "any" "order" seq ("and" seq)+
star: "star" seq
search: ("search" | "alone") seq
retry: "retry" NUMBER seq
try: "try" seq "else" seq
undoing: "do" seq ON_CANCEL seq

_condition: or
?or: and ("or" and)*
?and: negated ("and" negated)*
?negated: "not" negated -> not
    | "some" variables ":" or -> some
    | "all" variables ":" or _ARROW or -> all
    | atom
?atom: sum
    | sum COMPARISON sum -> comparison
    | sum "in" _values -> member
_values: range | set
range: sum _DOTS sum
set: "{" sum ("," sum)* "}"

?sum: product | sum (PLUS | MINUS) product -> operation
?product: factor | product (TIMES | OVER_SIGN | MODULO) factor -> operation
?factor: MINUS factor -> negative
    | "(" or ")"
    | variable
    | NUMBER -> constant
    | STRING -> constant
    | "true" -> true
    | "false" -> false
    | compound
compound: NAME ("(" (sum ("," sum)*)? ")")?

slips: UNKNOWN | QUOTED | OPEN

COMPARISON: "!=" | "<=" | ">=" | "<" | ">" | /=(?!=)/
_ARROW: "->"
_DOTS: ".."
PLUS: "+"
MINUS: "-"
TIMES: "*"
OVER_SIGN: "/"
MODULO: "\\"
ON_CANCEL.2: /on\s+cancel(?![A-Za-z0-9_])/
NUMBER: /[0-9]+/
VARIABLE: /[A-Z][A-Za-z0-9_]*|_(?![A-Za-z0-9_])/
NAME: /[a-z][A-Za-z0-9_]*/
STRING: /"([^"\\\n]|\\.)*"/s
QUOTED: /'[^'\n]*'/
OPEN.-1: /"[^\n]*/
UNKNOWN.-2: /==|./s
%ignore /\s+/
%ignore /%\*.*?\*%|%[^\n]*/s
"""

_WORDS = frozenset(re.findall('"([a-z]+)"', _GRAMMAR))
"""Names that no action, fluent or procedure can have."""

_CONDITIONS = "conditions stand behind test, if and while"
_INTERRUPTS = "write interrupts { when CONDITION {...} } until CONDITION;"
_MISPLACED = {
    "else": "it belongs right behind the {...} of if or try",
    "or": "write choose {...} or {...}",
    "and": "write any order {...} and {...}",
    "with": "write interleave {...} with {...}",
    "over": "write prefer {...} over {...}",
    "order": "write any order {...} and {...}",
    "when": _INTERRUPTS,
    "until": _INTERRUPTS,
    **dict.fromkeys(("not", "some", "all"), _CONDITIONS),
    "true": "write test true;",
    "false": "write test false;",
}
"""What to write in place of a word that begins no statement."""

_WANTED: Sequence[Tuple[str, str, str]] = (
    ("WHILE", "a statement", "write an action, or a word like if, while, pick"),
    ("NOT", "a condition", "write a fluent, or compare terms, as in X + 1 < 3"),
    ("NAME NUMBER", "a term", "write a name, a number or a variable"),
    ("VARIABLE", "a variable", "variables begin with a capital letter"),
    ("NAME", "the procedure's name", "names begin with a small letter"),
    ("NUMBER", "the number of attempts", "write retry 3 {...}"),
    ("STRING", "a file's name", 'write include "FILE";'),
    ("_ARROW", "'->'", "write -> as in all X: CONDITION -> CONDITION"),
    ("SEMICOLON", "';'", "write ;"),
    ("COLON", "':'", "write : as in pick X: CONDITION {...}, or pick X in 1..3 {...}"),
    ("LBRACE", "'{'", "write {"),
    ("RPAR", "')'", "write )"),
    ("_DOTS", "'..'", "write .. as in X in 1..3"),
    ("WHEN", "'when'", "write when CONDITION {...}"),
    ("RBRACE", "'}'", "write }"),
    ("ON_CANCEL", "'on cancel'", "write do {...} on cancel {...}"),
    ("UNTIL", "'until'", "write until CONDITION; behind the interrupts, for when they end"),
    ("ELSE", "'else'", "write else {...}, for what is done if an action fails"),
    ("OR", "'or'", "write or {...}, for another choice"),
    ("AND", "'and'", "write and {...}, for another part of any order"),
    ("WITH", "'with'", "write with {...}, for another part of interleave"),
    ("OVER", "'over'", "write over {...}, for another part of prefer"),
)
"""Types of tokens that a place accepts, what belongs there if it accepts them, and the mend; the first one counts."""

_INSTEAD = {
    "?": "write test CONDITION;",
    "|": "write or, or interleave {...} with {...}",
    "&": "write and",
    "!": "write not, or !=",
    "==": "write =",
}


_STATEMENTS = frozenset(
    [
        *("step", "any", "test", "await", "achieve", "interrupts", "every", "until", "if", "while", "pick", "seq"),
        *("choice", "conc", "prio", "order", "star", "search", "retry", "try", "undoing"),
    ]
)


class ControlProgram(NamedTuple):
    """A file: the nodes of the files that it includes and of its procedures."""

    includes: Tuple[SyntaxNode, ...]
    procedures: Tuple[SyntaxNode, ...]


@lru_cache(maxsize=None)
def _grammar() -> Grammar:
    return Grammar(_GRAMMAR, ("include", "procedure", "slips"))


def statements(one: SyntaxNode) -> List[SyntaxNode]:
    """Return the statements directly within one."""
    return [part for part in one.parts if part.kind in _STATEMENTS]


def signature(named: SyntaxNode) -> Tuple[str, int]:
    """Return the name and the number of arguments of a procedure, an action or a call."""
    arguments = parameters(named) if named.kind == "procedure" else named.parts
    return named.text, len(arguments)


def parameters(one: SyntaxNode) -> List[SyntaxNode]:
    """Return the variables that a procedure, ``pick``, ``when`` or a quantifier begins with."""
    first = one.parts[0]
    return first.parts if first.kind == "variables" else []


def choice(one: SyntaxNode) -> Tuple[List[SyntaxNode], SyntaxNode, SyntaxNode]:
    """Return the variables of ``pick`` or ``when``, the condition on them, and what is done."""
    condition, body = one.parts[-2:]
    if len(one.parts) == 2 and condition.kind == "member":
        return condition.parts[:1], condition, body
    return parameters(one), condition, body


def parse(text: str, name: str, faults: List[Fault]) -> ControlProgram:
    """Read a control program; what is wrong is added to ``faults``, with at most one of the syntax in a procedure."""
    found: List[SyntaxNode] = []
    tokens = [_mended(token, name, faults) for token in _grammar().tokens(text)]
    lines = text.split("\n")
    end = Token("$END", "", line=len(lines), column=len(lines[-1]) + 1)
    starts = [n for n, token in enumerate(tokens) if token.type in ("PROC", "INCLUDE")]
    if tokens and 0 not in starts:
        faults.append(_fault(name, tokens[0], f"'{tokens[0]}' outside of a procedure", "write proc NAME(X) { ... }"))
    for first, after in zip(starts, [*starts[1:], len(tokens)]):
        start = "procedure" if tokens[first].type == "PROC" else "include"
        try:
            found.append(_grammar().parse(tokens[first:after], (*tokens[after:], end)[0], start))
        except MisfitError as misfit:
            faults.append(_fault(name, *_told(misfit, tokens[first:after])))
    procedures = (one for one in found if one.kind == "procedure")
    return ControlProgram(tuple(one for one in found if one.kind == "include"), tuple(procedures))


def _fault(name: str, token: Token, message: str, mend: str) -> Fault:
    return Fault(name, token.line or 1, token.column or 1, message, mend)


def _mended(token: Token, name: str, faults: List[Fault]) -> Token:
    """Return a token as the grammar takes it; what is wrong with it by itself is added to ``faults``."""
    if token.type == "QUOTED":
        faults.append(_fault(name, token, f"{token} is no string", f'write "{token[1:-1]}"'))
        return token.update(type="STRING")
    if token.type == "NUMBER" and _is_great(token):
        mend = f"have at most {GREATEST}, or write it as a string"
        faults.append(_fault(name, token, f"the number {token} is too great", mend))
    return token


def _is_great(number: str) -> bool:
    digits = number.lstrip("0") or "0"
    return len(digits) > len(str(GREATEST)) or int(digits) > GREATEST


def _told(misfit: MisfitError, tokens: Sequence[Token]) -> Tuple[Token, str, str]:
    """Return the token to blame for tokens that are no procedure or include, what is wrong, and the mend."""
    token, accepted = misfit.token, misfit.accepted
    if not accepted:
        return token, "too much within each other", "make procedures of some"
    if token.type == "OPEN":
        return token, "the string has no end on its line", 'write " behind it'
    if token.type == "UNKNOWN":
        shown = f"'{token}'" if token in _INSTEAD else repr(str(token))
        return token, f"{shown} is no word of the language", _INSTEAD.get(token, "comments begin with %")
    at = next((n for n, one in enumerate(tokens) if one is token), len(tokens))
    if at == len(tokens) and _open(tokens):
        return _open(tokens)[-1], "the bracket '{' is never closed", "write } where it ends"
    shown = f"'{token}'" if token else "the end of the file"
    if accepted == {"$END"}:
        return token, f"{shown} outside of a procedure", "write proc NAME(X) { ... }"
    slip = _slip(tokens, at) if "SEMICOLON" in accepted else None
    if slip is not None:
        return slip[0], f"'{slip[0]}' is no word of the language, and no ';' is behind it", f"is {slip[1]} meant?"
    wanted = (row for row in _WANTED if set(row[0].split()) <= accepted)
    types, what, mend = next(wanted, ("", " or ".join(sorted(accepted)), "see doc/golog.md"))
    if token in _WORDS and types == "WHILE":
        mend = _MISPLACED.get(token, "no action has this name")
    elif token in _WORDS and not what.startswith("'"):
        shown += " is a word of the language"
    return token, f"{shown} where {what} belongs, behind '{tokens[at - 1]}'", mend


def _open(tokens: Sequence[Token]) -> List[Token]:
    """Return the braces that none closes."""
    found: List[Token] = []
    for token in tokens:
        if token == "{":
            found.append(token)
        elif token == "}" and found:
            found.pop()
    return found


def _slip(tokens: Sequence[Token], at: int) -> Optional[Tuple[Token, str]]:
    """Return the name that begins the statement around a place, and the word that it may be a slip of, if it is."""
    begin = next((n for n in range(at - 1, 0, -1) if tokens[n - 1] in ("{", "}", ";")), 0)
    meant = next((word for word in sorted(_WORDS) if is_slip(tokens[begin], word)), None)
    return (tokens[begin], meant) if meant and tokens[begin].type == "NAME" else None
