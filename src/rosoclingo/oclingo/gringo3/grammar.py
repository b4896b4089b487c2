"""The grammar of gringo 3's statements and oClingo's directives, with messages about syntax errors."""

from functools import lru_cache
from typing import AbstractSet, Callable, Dict, Iterator, NamedTuple, Optional, Sequence, Union

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.grammars import Grammar, MisfitError, SyntaxNode
from rosoclingo.oclingo.grammars import Token as GrammarToken
from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind

_GRAMMAR = r"""
?statement: rule | weak | script | directive
rule: _head "." | _head? ":-" body? "."
weak: ":~" body? "." ("<" weight_term? (":" priority_term)? ">")?
weight_term: pool
priority_term: pool
script: SCRIPT

?directive: "#base" "." -> base
    | PART IDENTIFIER (":" pool)? "." -> part
    | "#program" IDENTIFIER ("(" IDENTIFIER ")")? "." -> program
    | "#forget" IDENTIFIER (":" pool)? "." -> forget
    | "#iinit" pool "." -> iinit
    | "#const" IDENTIFIER "=" pool "." -> const
    | "#include" STRING "." -> include
    | "#domain" positive "." -> domain
    | DISPLAY (signatures | shown)? "." -> display
    | "#external" (signature | shown) "." -> external
    | OPTIMIZE _elements_in_brackets "." -> optimize
    | "#compute" NUMBER? braces "." -> compute
signatures: signature ("," signature)*
signature: "-"? IDENTIFIER "/" NUMBER
shown: positive _conditions? -> element

_head: positive | disjunction | aggregate
disjunction: conditioned | (positive_element | conditioned) ("|" (positive_element | conditioned))+
positive_element: positive -> element
conditioned: positive _conditions -> element
positive: pool -> literal

body: _item ("," _item)*
_item: _literal | alone | aggregate | negated
alone: _literal _conditions -> element
negated: "not" aggregate

aggregate: _before? _elements_in_brackets _after?
_before: pool _sign? | pool ASSIGN | variable "="
_after: _sign? pool
_elements_in_brackets: braces | brackets
braces: FUNCTION? "{" (_elements ","?)? "}"
brackets: FUNCTION? "[" (_elements ","?)? "]"
_elements: (element | tuple) | _elements "," (element | tuple)
element: _plain (_conditions? weight? priority? | weight priority? _conditions | priority _conditions)
tuple: "<" tuple_terms? ">" (priority? _conditions? | _conditions priority) -> element
tuple_terms: pool ("," pool)*
weight: "=" pool
priority: "@" pool

_conditions: (":" _literal)+
_literal: _plain | assignment
assignment: (pool ASSIGN | variable "=") pool -> comparison
_plain: literal | comparison
literal: "not"? (pool | boolean)
boolean: BOOLEAN -> symbol
comparison: "not"? pool _sign pool
_sign: "<" | ">" | SIGN

?pool: interval (";" interval)*
?interval: operation | interval ".." operation
?operation: _operand ((OPERATOR | "-" | "/" | CALLED) _operand)*
_operand: primary | signed
signed: ("-" | "~") _operand
?primary: (IDENTIFIER | NUMBER | STRING | BOUND) -> symbol
    | IDENTIFIER? "(" _lists ")" -> function
    | variable
    | ("|" pool "|" | "#abs" "(" pool ")") -> absolute
    | CALLED "(" pool "," pool ")" -> call
    | "@" IDENTIFIER ("(" _lists ")")? -> script_call
_lists: list | _lists ";;" list
list: _terms | _terms ","
_terms: pool | _terms "," pool
variable: VARIABLE

ASSIGN: ":="
PART: "#cumulative" | "#volatile"
DISPLAY: "#show" | "#hide"
OPTIMIZE: "#minimize" | "#minimise" | "#maximize" | "#maximise"
FUNCTION: "#count" | "#sum" | "#sum+" | "#min" | "#max" | "#avg" | "#even" | "#odd"
BOOLEAN: "#true" | "#false"
BOUND: "#infimum" | "#supremum"
CALLED: "#mod" | "#div" | "#pow"
SIGN: "==" | "!=" | "<=" | ">="
OPERATOR: "+" | "*" | "\\" | "**" | "&" | "^" | "?"
%declare IDENTIFIER VARIABLE NUMBER STRING SCRIPT
"""

_LPARSE_WORDS = ("minimize", "minimise", "maximize", "maximise", "compute", "const", "hide", "show", "domain")
_TYPES = {
    TokenKind.IDENTIFIER: "IDENTIFIER",
    TokenKind.VARIABLE: "VARIABLE",
    TokenKind.ANONYMOUS: "VARIABLE",
    TokenKind.NUMBER: "NUMBER",
    TokenKind.STRING: "STRING",
    TokenKind.SCRIPT: "SCRIPT",
}
_WANTED = (
    {"VARIABLE": "a term"},
    {"IDENTIFIER": "a name", "STRING": "a file name in quotes"},
    {
        **{"NUMBER": "a number", "DOT": "'.'", "COMMA": "','"},
        **{"RPAR": "')'", "RBRACE": "'}'", "RSQB": "']'", "LBRACE": "'{'", "LSQB": "'['"},
    },
    {"COLON": "':'", "EQUAL": "'='", "SLASH": "'/'", "MORETHAN": "'>'"},
)
"""Names of token types in messages; a message lists the accepted types of the first row that contains any."""

_SCRIPTS = {
    "script": ("scripts cannot be translated", "write the results of the script as facts"),
    "script_call": ("calls of script functions cannot be translated", "write their results as facts"),
}
_DIRECTIONS = ({"<", "<="}, {">", ">="})
_TWO_BOUNDS = "compare in one direction on both sides, as 1 <= { a, b } < 3, or omit both comparisons"
PARITIES = ("#even", "#odd")
OPTIMIZE = ("#minimize", "#minimise", "#maximize", "#maximise")
SUMS = ("#sum", "#sum+", "#min", "#max")


Place = Union[SourceToken, GrammarToken, SyntaxNode]


class UntranslatableError(Exception):
    """A statement cannot be translated; the translator collects these errors in a :class:`TranslationError`.

    Attributes:
        limits: whether the statement is valid in gringo 3 but outside the limits of the translation.

    """

    def __init__(self, place: Place, message: str, remedy: str = "", limits: bool = False) -> None:
        self.line, self.column, self.message, self.remedy = place.line or 1, place.column or 1, message, remedy
        self.limits = limits
        super().__init__(message)

    def fault(self, file: str) -> Fault:
        """Return the error as a fault of a file."""
        return Fault(file, self.line, self.column, self.message, self.remedy)


class Aggregate(NamedTuple):
    """The parts of an aggregate: brackets, function, bounds, and the relations between them ("" if omitted).

    ``before`` is ``=`` or ``:=`` if the value of the aggregate is assigned to ``lower``.
    """

    core: SyntaxNode
    function: str
    lower: Optional[SyntaxNode]
    before: str
    after: str
    upper: Optional[SyntaxNode]

    @property
    def assigned(self) -> bool:
        """Whether the aggregate's value is assigned to a term."""
        return self.before in ("=", ":=")

    @property
    def is_set(self) -> bool:
        """Whether the elements are in braces."""
        return self.core.kind == "braces"


def aggregate_of(node: SyntaxNode) -> Aggregate:
    """Return the parts of an aggregate, which can be negated."""
    children = node.parts[-1].children if node.kind == "negated" else node.children
    at = next(n for n, one in enumerate(children) if isinstance(one, SyntaxNode) and one.kind in ("braces", "brackets"))
    core, sides = children[at], (children[:at], children[at + 1 :])
    assert isinstance(core, SyntaxNode)
    (lower, upper) = (next((one for one in side if isinstance(one, SyntaxNode)), None) for side in sides)
    (before, after) = (next((str(one) for one in side if not isinstance(one, SyntaxNode)), "") for side in sides)
    return Aggregate(core, core.text if core.text.startswith("#") else "", lower, before, after, upper)


@lru_cache(maxsize=None)
def _grammar() -> Grammar:
    return Grammar(_GRAMMAR, ("statement",), lexed=False)


def parse(tokens: Sequence[SourceToken], first: int, after: int) -> SyntaxNode:
    """Return the syntax tree of a statement; its positions are token indices.

    Raises :class:`UntranslatableError`.
    """
    word = tokens[first]
    remedy = f"write '#{word.text}' for the directive" if word.text in _LPARSE_WORDS else ""
    if remedy and tokens[first + 1].text in ("[", "{"):
        raise UntranslatableError(word, f"'{word.text}' before an aggregate is not a number", remedy)
    if word.kind is TokenKind.DIRECTIVE and not _grammar().type_of(word.text):
        raise UntranslatableError(word, f"gringo 3 has no directive '{word.text}'")
    try:
        found = _grammar().parse(_read(tokens, first, after), GrammarToken("$END", ""), "statement")
    except MisfitError as misfit:
        raise _refusal(tokens[misfit.token.start_pos or 0], misfit.accepted, remedy) from None
    for node in found.walk():
        if node.kind in _SCRIPTS:
            raise UntranslatableError(node, *_SCRIPTS[node.kind], limits=True)
        if node.kind in _CHECKS:
            _CHECKS[node.kind](node, tokens)
    return found


def _read(tokens: Sequence[SourceToken], first: int, after: int) -> Iterator[GrammarToken]:
    for index in range(first, after):
        one = tokens[index]
        written_out = one.kind in (TokenKind.SYMBOL, TokenKind.DIRECTIVE) or one.text == "not"
        kind = _grammar().type_of(one.text) if written_out else _TYPES.get(one.kind, "")
        kind = "" if one.text.startswith("#script") else kind
        yield GrammarToken(kind or "UNKNOWN", one.text, index, one.line, one.column, one.line, one.column, index + 1)


def _refusal(token: SourceToken, accepted: AbstractSet[str], remedy: str) -> UntranslatableError:
    """Return the error for a token that the grammar does not accept."""
    if not accepted:
        return UntranslatableError(token, "terms are nested too deeply", limits=True)
    rows = ([name for kind, name in row.items() if kind in accepted] for row in _WANTED)
    return unexpected(token, " or ".join(next(filter(None, rows), [])), remedy)


def unexpected(token: Place, wanted: str, remedy: str = "") -> UntranslatableError:
    """Return the error for an unexpected token, or the first token of an unexpected node."""
    token = token.first if isinstance(token, SyntaxNode) else token
    shown = token.shown() if isinstance(token, SourceToken) else f"'{token}'"
    message = f"unexpected {shown}" + (f", expected {wanted}" if wanted else "")
    return UntranslatableError(token, message, remedy)


# ---- conditions that the grammar does not express ------------------------------------------------------------------


def _check_literal(literal: SyntaxNode, tokens: Sequence[SourceToken]) -> None:
    atom = literal.parts[0]
    atom = atom.parts[0] if atom.kind == "signed" and atom.text == "-" else atom
    named = atom.kind in ("function", "symbol") and atom.text.strip("_")[:1].islower()
    if not named and atom.text not in ("#true", "#false"):
        raise unexpected(tokens[literal.span[1]], "a comparison, since the preceding term is not an atom")


def _check_comparison(comparison: SyntaxNode, tokens: Sequence[SourceToken]) -> None:
    if comparison.text == "not":
        raise UntranslatableError(comparison.tokens[1], "a comparison cannot be negated", "use the opposite comparison")


def _check_owner(owner: SyntaxNode, tokens: Sequence[SourceToken]) -> None:
    """Raise :class:`UntranslatableError` for an assignment by an aggregate in a head or after ``not``."""
    aggregate = owner.parts[0] if owner.parts else None
    if aggregate and aggregate.kind == "aggregate" and aggregate_of(aggregate).assigned:
        raise unexpected(aggregate.tokens[0], "a comparison")


def _check_aggregate(node: SyntaxNode, tokens: Sequence[SourceToken]) -> None:
    parts = aggregate_of(node)
    if "!=" in (parts.before, parts.after):
        raise unexpected(node.tokens[0 if parts.before == "!=" else -1], "another comparison")
    if parts.function in PARITIES or (parts.function == "#avg" and parts.assigned):
        if parts.assigned:
            raise UntranslatableError(parts.core, f"the value of {parts.function} cannot be assigned")
        if parts.lower or parts.upper:
            raise UntranslatableError(parts.core, f"{parts.function} takes no bounds")
    if parts.function == "#avg" and not {parts.before, parts.after}.isdisjoint({"<", ">"}):
        raise UntranslatableError(parts.core, "'<' and '>' next to an average cannot be translated", "write '<='")
    alike = not parts.before + parts.after or any({parts.before, parts.after} <= one for one in _DIRECTIONS)
    if parts.lower and parts.upper and not alike:
        raise UntranslatableError(tokens[parts.core.span[1]], "these bounds do not fit together", _TWO_BOUNDS)
    _check_elements(parts.core, tokens, parts.function)


def _check_optimize(node: SyntaxNode, tokens: Sequence[SourceToken]) -> None:
    core = node.parts[0]
    if core.text.startswith("#"):
        raise unexpected(core, "'{' or '['")
    _check_elements(core, tokens, node.text)
    for element in core.parts:
        if element.parts[0].kind == "comparison":
            raise UntranslatableError(element, "unexpected comparison")


def _check_elements(core: SyntaxNode, tokens: Sequence[SourceToken], owner: str) -> None:
    """Raise :class:`UntranslatableError` for an element that its owner, a function or a directive, does not allow."""
    optimizes, is_set = owner in OPTIMIZE, core.kind == "braces"
    if is_set and owner == "#avg":
        raise unexpected(core.tokens[1], "'['")
    for element in core.parts:
        kinds = {part.kind: part for part in element.parts}
        angled = element.children[0] == "<"
        if angled and owner in (*PARITIES, "#compute"):
            raise UntranslatableError(element, f"{owner} takes no tuples")
        if owner == "#count" and "weight" in kinds:
            raise UntranslatableError(element, "#count takes no weights", "use #sum")
        if is_set and owner in SUMS and "tuple_terms" not in kinds:
            raise UntranslatableError(
                element, f"{owner} {{ .. }} takes tuples", f"write <weight> : literal, or {owner} [ .. ]"
            )
        if optimizes and angled and "tuple_terms" not in kinds:
            raise UntranslatableError(element, "a tuple in '<>' needs a weight")
        odd = [kinds[kind] for kind in ("weight", "priority") if kind in kinds]
        odd = [one for one in odd if (is_set if one.kind == "weight" else not optimizes)]
        if odd or (angled and not is_set):
            raise unexpected(odd[0] if odd else element, "','" if odd else "a literal")
        if angled and not optimizes and kinds.keys() <= {"tuple_terms"}:
            raise unexpected(tokens[element.span[1]], "':'")


_CHECKS: Dict[str, Callable[[SyntaxNode, Sequence[SourceToken]], None]] = {
    "literal": _check_literal,
    "comparison": _check_comparison,
    "negated": _check_owner,
    "rule": _check_owner,
    "aggregate": _check_aggregate,
    "optimize": _check_optimize,
    "compute": _check_optimize,
}
