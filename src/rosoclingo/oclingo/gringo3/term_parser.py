"""Recursive descent over the terms of gringo 3's language."""

from typing import List, Optional, Sequence, Tuple

from rosoclingo.oclingo.gringo3.lexer import Kind, RefusalError, Token
from rosoclingo.oclingo.gringo3.syntax import (
    Absolute,
    Function,
    Interval,
    Operation,
    Pool,
    Signed,
    Symbol,
    Term,
    Variable,
)

MAXIMAL_DEPTH = 80
"""How deep terms may be nested; more would exhaust Python's stack."""

_BINARY = {"+": "+", "-": "-", "*": "*", "/": "/", "\\": "\\", "**": "**", "&": "&", "^": "^", "?": "?"}
_NAMED_BINARY = {"#mod": "\\", "#div": "/", "#pow": "**"}
_BOUNDS = {"#infimum", "#supremum"}
_ATOMIC = (Symbol, Variable, Function, Absolute)


class TermParser:
    """A cursor over the tokens of one statement with the grammar's rules for terms as methods.

    Every method raises :class:`RefusalError` at the token that does not fit.
    """

    def __init__(self, tokens: Sequence[Token], first: int, after: int) -> None:
        self._tokens, self._after = tokens, after
        self._depth = 0
        self.index = first

    @property
    def token(self) -> Token:
        """The token at the cursor."""
        return self._tokens[self.index]

    def at(self, *texts: str) -> bool:
        """Whether one of these is at the cursor."""
        return self.index < self._after and self.token.kind is not Kind.STRING and self.token.text in texts

    def at_kind(self, *kinds: Kind) -> bool:
        """Whether a token of one of these kinds is at the cursor."""
        return self.index < self._after and self.token.kind in kinds

    def accept(self, *texts: str) -> Optional[int]:
        """Step over a token if it is one of these; its index."""
        return self.step() if self.at(*texts) else None

    def step(self) -> int:
        """Step over the token at the cursor; its index."""
        self.index += 1
        return self.index - 1

    def expect(self, text: str) -> int:
        """Step over a token that has to be there; its index."""
        if not self.at(text):
            raise self.unexpected(f"'{text}'")
        return self.step()

    def unexpected(self, wanted: str) -> RefusalError:
        """The error that something else is needed at the cursor."""
        return RefusalError(self.token, f"{self.token.shown()} is not expected here, but {wanted}")

    def term(self) -> Term:
        """A term, which may be a pool."""
        options = [self._interval()]
        while self.accept(";") is not None:
            options.append(self._interval())
        return options[0] if len(options) == 1 else Pool(tuple(options))

    def arguments(self) -> Tuple[Tuple[Term, ...], ...]:
        """Lists of arguments, separated by ``;;``, up to a closing parenthesis or a trailing comma."""
        lists = [self._argument_list()]
        while self.accept(";;") is not None:
            lists.append(self._argument_list())
        return tuple(lists)

    def _argument_list(self) -> Tuple[Term, ...]:
        terms = [self.term()]
        while self.at(",") and self._tokens[self.index + 1].text != ")":
            self.step()
            terms.append(self.term())
        return tuple(terms)

    def _interval(self) -> Term:
        low = self._operation()
        while self.accept("..") is not None:
            low = Interval(low, self._operation())
        return low

    def _operation(self) -> Term:
        self._depth += 1
        if self._depth > MAXIMAL_DEPTH:
            raise RefusalError(self.token, "terms are nested too deeply here", f"more than {MAXIMAL_DEPTH} deep")
        terms, operators = [self._operand()], []
        while self.at(*_BINARY, *_NAMED_BINARY):
            text = self._tokens[self.step()].text
            operators.append(_BINARY.get(text) or _NAMED_BINARY[text])
            terms.append(self._operand())
        self._depth -= 1
        return Operation(tuple(terms), tuple(operators)) if operators else terms[0]

    def _operand(self) -> Term:
        signs = []
        while self.at("-", "~"):
            signs.append(self._tokens[self.step()].text)
            if len(signs) > MAXIMAL_DEPTH:
                raise RefusalError(self.token, "there are too many signs here")
        term = self._primary()
        for sign in reversed(signs):
            term = Signed(sign, term)
        return term

    def _primary(self) -> Term:
        if self.at_kind(Kind.IDENTIFIER) and not self.at("not"):
            return self._named()
        if self.at_kind(Kind.NUMBER, Kind.STRING) or self.at(*_BOUNDS):
            return Symbol(self._tokens[self.step()].text)
        if self.at_kind(Kind.VARIABLE, Kind.ANONYMOUS):
            return Variable(self._tokens[self.step()].text)
        if self.at("("):
            return self._parenthesised("")
        return self._special()

    def _named(self) -> Term:
        name = self._tokens[self.step()].text
        return self._parenthesised(name) if self.at("(") else Symbol(name)

    def _parenthesised(self, name: str) -> Term:
        self.expect("(")
        lists = self.arguments()
        comma = not name and self.accept(",") is not None
        self.expect(")")
        return Function(name, lists, comma)

    def _special(self) -> Term:
        if self.accept("|") is not None:
            term = self.term()
            self.expect("|")
            return Absolute(term)
        if self.accept("#abs") is not None:
            return Absolute(self._function_arguments(1)[0])
        if self.at(*_NAMED_BINARY):
            operator = _NAMED_BINARY[self._tokens[self.step()].text]
            left, right = self._function_arguments(2)
            return Function("", ((Operation((left, right), (operator,)),),))
        if self.at("@"):
            raise RefusalError(
                self.token, "calls of script functions cannot be translated", "state their results as facts"
            )
        raise self.unexpected("a term")

    def _function_arguments(self, count: int) -> List[Term]:
        self.expect("(")
        terms = list(self._argument_list())
        if len(terms) != count:
            raise RefusalError(self.token, f"this function takes {count} argument(s)")
        self.expect(")")
        return [term if isinstance(term, _ATOMIC) or count == 1 else Function("", ((term,),)) for term in terms]
