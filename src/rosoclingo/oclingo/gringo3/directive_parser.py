"""Recursive descent over the directives of gringo 3 and of oClingo."""

from dataclasses import dataclass
from typing import List, Optional, Tuple, Union

from rosoclingo.oclingo.gringo3.lexer import Kind, RefusalError
from rosoclingo.oclingo.gringo3.statement_parser import StatementParser
from rosoclingo.oclingo.gringo3.syntax import Element, Function, Literal, Signed, Span, Symbol, Term, Variable, show

Signature = Tuple[str, int]
"""A predicate's name, with ``-`` in front if it is negated classically, and the number of its arguments."""


@dataclass(frozen=True)
class TermDirective:
    """A directive that holds at most an identifier and a term: ``#volatile t : w``, ``#const n = 1``."""

    identifier: str
    term: Optional[Term]
    span: Span


@dataclass(frozen=True)
class Display:
    """``#show`` or ``#hide``: of everything, of signatures, or of atoms under conditions; token indices as in rules."""

    shows: bool
    signatures: Tuple[Signature, ...]
    element: Optional[Element]
    dot: int


@dataclass(frozen=True)
class Elements:
    """``#minimize``, ``#maximize`` or ``#compute`` with its elements, the span of its brackets and its commas."""

    elements: Tuple[Element, ...]
    commas: Tuple[int, ...]
    inside: Span
    bracket: str
    dot: int


class DirectiveParser(StatementParser):
    """The grammar's rules for directives; the cursor is behind the directive's name."""

    def term_directive(self, identifier: bool, mark: str) -> TermDirective:
        """``identifier mark term``, where the identifier may be absent in general, mark and term in the text."""
        name = self._tokens[self._identifier()].text if identifier else ""
        first = self.index
        term = None
        if not mark or self.accept(mark) is not None:
            first = self.index
            term = self.term()
        span = (first, self.index)
        self.dot()
        return TermDirective(name, term, span)

    def part(self) -> str:
        """``name.`` or ``name(parameter).``, today's name of a part; its parameter, if it has one."""
        self._identifier()
        parameter = ""
        if self.accept("(") is not None:
            parameter = self._tokens[self._identifier()].text
            self.expect(")")
        self.dot()
        return parameter

    def include(self) -> None:
        """A file's name."""
        if not self.at_kind(Kind.STRING):
            raise self.unexpected("a file name in quotes")
        self.step()
        self.dot()

    def domain(self) -> Tuple[str, List[str]]:
        """The atom that ``#domain`` declares, as text, and its variables."""
        literal = self.literal(assignments=False)
        atom = literal.left.term if isinstance(literal.left, Signed) else literal.left
        terms = atom.lists[0] if isinstance(atom, Function) and not literal.negated else ()
        if not terms or not all(isinstance(term, Variable) and term.name != "_" for term in terms):
            raise RefusalError(self._tokens[literal.span[0]], "#domain takes an atom whose arguments are variables")
        self.dot()
        names = [term.name for term in terms if isinstance(term, Variable)]
        return show(literal.left), names

    def display(self, shows: bool) -> Display:
        """What follows ``#show`` or ``#hide``."""
        if self.at("."):
            return Display(shows, (), None, self.dot())
        if self._at_signature():
            signatures = [self.signature()]
            while self.accept(",") is not None:
                signatures.append(self.signature())
            return Display(shows, tuple(signatures), None, self.dot())
        element = self._conditioned_atom()
        return Display(shows, (), element, self.dot())

    def external(self) -> Union[Signature, Element]:
        """What follows ``#external``: a signature or an atom with conditions."""
        found = self.signature() if self._at_signature() else self._conditioned_atom()
        self.dot()
        return found

    def minimize(self) -> Elements:
        """The elements of ``#minimize`` or ``#maximize``."""
        return self._elements(priorities=True)

    def compute(self) -> Elements:
        """The elements of ``#compute``; the number in front of them has no meaning any more."""
        if self.at_kind(Kind.NUMBER):
            self.step()
        if not self.at("{"):
            raise self.unexpected("'{'")
        return self._elements(priorities=False)

    def signature(self) -> Signature:
        """``name/arity``."""
        sign = "-" if self.accept("-") is not None else ""
        name = self._tokens[self._identifier()].text
        self.expect("/")
        if not self.at_kind(Kind.NUMBER):
            raise self.unexpected("the number of arguments")
        return sign + name, int(self._tokens[self.step()].text)

    def _identifier(self) -> int:
        if not self.at_kind(Kind.IDENTIFIER):
            raise self.unexpected("a name")
        return self.step()

    def _at_signature(self) -> bool:
        ahead = [token.text for token in self._tokens[self.index : self.index + 3]]
        return ahead[1:2] == ["/"] or (ahead[:1] == ["-"] and ahead[2:] == ["/"])

    def _conditioned_atom(self) -> Element:
        first = self.index
        literal = self.literal(assignments=False)
        self.require_atom(literal)
        if literal.negated:
            raise RefusalError(self._tokens[first], "'not' is not expected here")
        conditions = self.conditions()
        return Element((first, self.index), literal, conditions)

    def require_atom(self, literal: Literal) -> None:
        """:class:`RefusalError` if a literal is a comparison."""
        if not literal.is_atom:
            raise RefusalError(self._tokens[literal.span[0]], "a comparison is not expected here")

    def _elements(self, priorities: bool) -> Elements:
        if not self.at("{", "["):
            raise self.unexpected("'{' or '['")
        bracket, first = self.token.text, self.index
        elements, commas = self.elements(bracket, priorities)
        for element in elements:
            if element.terms is None:
                self.require_atom(element.literal)
            elif not priorities:
                raise RefusalError(self._tokens[element.span[0]], "#compute takes no tuples")
            elif not element.terms:
                raise RefusalError(self._tokens[element.span[0]], "a tuple in '<>' needs a weight")
        return Elements(elements, commas, (first, self.index), bracket, self.dot())


def signature_of(term: Term) -> List[Signature]:
    """The signatures of an atom; lists of arguments separated by ``;;`` may differ in length."""
    sign, inner = ("-", term.term) if isinstance(term, Signed) else ("", term)
    if isinstance(inner, Symbol):
        return [(sign + inner.text, 0)]
    return [(sign + inner.name, len(terms)) for terms in inner.lists] if isinstance(inner, Function) else []
