"""The grammar of control programs, with messages about syntax errors."""

import re
from functools import lru_cache
from typing import List, Mapping, NamedTuple, Optional, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.grammars import Grammar, MisfitError, SyntaxNode, Token
from rosoclingo.oclingo.program.likeness import is_misspelling

GREATEST = 2**31 - 1
"""The largest number in clingo, which would silently truncate larger ones."""

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
"""Keywords, which cannot be names of actions, fluents or procedures."""

_CONDITIONS = "write conditions after test, if or while"
_INTERRUPTS = "write interrupts { when CONDITION {...} } until CONDITION;"
_MISPLACED = {
    "else": "write it directly after the {...} of if or try",
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
"""Fixes for keywords that do not begin a statement."""

_WANTED: Sequence[Tuple[str, str, str]] = (
    ("WHILE", "a statement", "write an action, or a keyword such as if, while, pick"),
    ("NOT", "a condition", "write a fluent, or compare terms, as in X + 1 < 3"),
    ("NAME NUMBER", "a term", "write a name, a number or a variable"),
    ("VARIABLE", "a variable", "variables begin with an upper-case letter"),
    ("NAME", "the procedure's name", "names begin with a lower-case letter"),
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
    ("UNTIL", "'until'", "write until CONDITION; after the interrupts: they end when it holds"),
    ("ELSE", "'else'", "write else {...}, which runs if an action fails"),
    ("OR", "'or'", "write or {...} for another choice"),
    ("AND", "'and'", "write and {...} for another part of any order"),
    ("WITH", "'with'", "write with {...} for another part of interleave"),
    ("OVER", "'over'", "write over {...} for another part of prefer"),
)
"""Token types, their description in messages, and a fix; the first row whose types are all accepted applies."""

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
    """A file: the nodes of its includes and of its procedures, and its syntax errors."""

    includes: List[SyntaxNode]
    procedures: List[SyntaxNode]
    faults: List[Fault]


class Declaration(NamedTuple):
    """A procedure, and the number and name of its file."""

    number: int
    file: str
    procedure: SyntaxNode


Signature = Tuple[str, int]
"""The name and the number of arguments of a procedure, an action or a call."""

Procedures = Mapping[Signature, Declaration]


@lru_cache(maxsize=None)
def _grammar() -> Grammar:
    return Grammar(_GRAMMAR, ("include", "procedure", "slips"))


def statements(one: SyntaxNode) -> List[SyntaxNode]:
    """Return the direct substatements of a statement."""
    return [part for part in one.parts if part.kind in _STATEMENTS]


def signature(named: SyntaxNode) -> Signature:
    """Return the signature of a procedure, an action or a call."""
    arguments = parameters(named) if named.kind == "procedure" else named.parts
    return named.text, len(arguments)


def parameters(one: SyntaxNode) -> List[SyntaxNode]:
    """Return the variables that a procedure, ``pick``, ``when`` or a quantifier binds."""
    first = one.parts[0]
    return first.parts if first.kind == "variables" else []


def choice(one: SyntaxNode) -> Tuple[List[SyntaxNode], SyntaxNode, SyntaxNode]:
    """Return the variables, the condition and the body of ``pick`` or ``when``."""
    condition, body = one.parts[-2:]
    if len(one.parts) == 2 and condition.kind == "member":
        return condition.parts[:1], condition, body
    return parameters(one), condition, body


def parse(text: str, name: str) -> ControlProgram:
    """Parse a control program; it has at most one syntax error for each procedure."""
    program = ControlProgram([], [], [])
    faults = program.faults
    tokens = [_checked(token, name, faults) for token in _grammar().tokens(text)]
    lines = text.split("\n")
    end = Token("$END", "", line=len(lines), column=len(lines[-1]) + 1)
    starts = [n for n, token in enumerate(tokens) if token.type in ("PROC", "INCLUDE")]
    if tokens and 0 not in starts:
        faults.append(_fault(name, tokens[0], f"'{tokens[0]}' outside a procedure", "write proc NAME(X) { ... }"))
    for first, after in zip(starts, [*starts[1:], len(tokens)]):
        is_procedure = tokens[first].type == "PROC"
        start, found = ("procedure", program.procedures) if is_procedure else ("include", program.includes)
        try:
            found.append(_grammar().parse(tokens[first:after], (*tokens[after:], end)[0], start))
        except MisfitError as misfit:
            faults.append(_fault(name, *_explained(misfit, tokens[first:after])))
    return program


def _fault(name: str, token: Token, message: str, remedy: str) -> Fault:
    return Fault(name, token.line or 1, token.column or 1, message, remedy)


def _checked(token: Token, name: str, faults: List[Fault]) -> Token:
    """Return a token that the grammar accepts; add errors within the token to ``faults``."""
    if token.type == "QUOTED":
        faults.append(_fault(name, token, f"{token} is not a string", f'write "{token[1:-1]}"'))
        return token.update(type="STRING")
    digits = token.lstrip("0") if token.type == "NUMBER" else ""
    if len(digits) > len(str(GREATEST)) or int(digits or "0") > GREATEST:  # int() rejects very long texts
        remedy = f"write at most {GREATEST}, or a string"
        faults.append(_fault(name, token, f"the number {token} is too large", remedy))
    return token


def _explained(misfit: MisfitError, tokens: Sequence[Token]) -> Tuple[Token, str, str]:
    """Return the token at which a syntax error is reported, the message and the fix."""
    token, accepted = misfit.token, misfit.accepted
    if not accepted:
        return token, "nesting is too deep", "move some of it into procedures"
    if token.type == "OPEN":
        return token, "the string does not end on its line", 'write " after it'
    if token.type == "UNKNOWN":
        shown = f"'{token}'" if token in _INSTEAD else repr(str(token))
        return token, f"{shown} is not part of the language", _INSTEAD.get(token, "comments begin with %")
    at = next((n for n, one in enumerate(tokens) if one is token), len(tokens))
    if at == len(tokens) and _open(tokens):
        return _open(tokens)[-1], "the bracket '{' is never closed", "write } where it ends"
    shown = f"'{token}'" if token else "the end of the file"
    if accepted == {"$END"}:
        return token, f"{shown} outside a procedure", "write proc NAME(X) { ... }"
    slip = _slip(tokens, at) if "SEMICOLON" in accepted else None
    if slip is not None:
        return slip[0], f"'{slip[0]}' is not a keyword, and no ';' follows it", f"did you mean {slip[1]}?"
    wanted = (row for row in _WANTED if set(row[0].split()) <= accepted)
    types, what, remedy = next(wanted, ("", " or ".join(sorted(accepted)), "see doc/golog.md"))
    if token in _WORDS and types == "WHILE":
        remedy = _MISPLACED.get(token, "actions cannot have this name")
    elif token in _WORDS and not what.startswith("'"):
        shown = f"the keyword {shown}"
    return token, f"expected {what} after '{tokens[at - 1]}', found {shown}", remedy


def _open(tokens: Sequence[Token]) -> List[Token]:
    """Return the opening braces that have no closing brace."""
    found: List[Token] = []
    for token in tokens:
        if token == "{":
            found.append(token)
        elif token == "}" and found:
            found.pop()
    return found


def _slip(tokens: Sequence[Token], at: int) -> Optional[Tuple[Token, str]]:
    """Return the first name of the statement at a place with the keyword that it misspells, if it does."""
    begin = next((n for n in range(at - 1, 0, -1) if tokens[n - 1] in ("{", "}", ";")), 0)
    meant = next((word for word in sorted(_WORDS) if is_misspelling(tokens[begin], word)), None)
    return (tokens[begin], meant) if meant and tokens[begin].type == "NAME" else None
