"""A reader's place among the words of a control program, and how terms are read."""

from typing import Callable, List, Tuple, TypeVar, Union

from rosoclingo.languages.golog.scanner import GologError, Token
from rosoclingo.languages.golog.tree import Compound, Constant, Operation, Term, Variable
from rosoclingo.oclingo.errors import Fault

Read = TypeVar("Read")
DEPTH = 40
"""So deep may programs, conditions and terms be nested."""


class Reader:
    """Reads one word after the other."""

    def __init__(self, tokens: List[Token], name: str) -> None:
        self._tokens, self._name, self._place, self._depth = tokens, name, 0, 0

    @property
    def next(self) -> Token:
        """The word that is read next."""
        return self._tokens[self._place]

    def read(self) -> Token:
        """Read a word."""
        token = self.next
        self._place += token.kind != "end"
        return token

    def sees(self, *texts: str) -> bool:
        """Whether the next word is one of these."""
        return self.next.text in texts and self.next.kind in ("word", "sign")

    def sees_words(self, *texts: str) -> bool:
        """Whether these words are next, reserved or not."""
        return [one.text for one in self._tokens[self._place : self._place + len(texts)]] == list(texts)

    def took(self, *texts: str) -> bool:
        """Read one of these if it is next; tell whether it was."""
        if self.sees(*texts):
            self.read()
            return True
        return False

    def take(self, text: str, where: str) -> Token:
        """Read this word; ``where`` tells what it belongs to."""
        if not self.sees(text):
            raise self.fault(self.next, f"{self.next} where '{text}' belongs, {where}", f"write {text}")
        return self.read()

    def take_kind(self, kind: str, what: str, mend: str) -> Token:
        """Read a word of a kind."""
        if self.next.kind != kind:
            reserved = f"'{self.next.text}' is a word of the language" if self.next.kind == "word" else str(self.next)
            raise self.fault(self.next, f"{reserved} where {what} belongs", mend)
        return self.read()

    def fault(self, token: Token, message: str, mend: str) -> GologError:
        """Return an error at a word."""
        return GologError(Fault(self._name, token.line, token.column, message, mend))

    def attempt(self, way: Callable[[], Read]) -> Union[Read, GologError]:
        """Return what is read in a way, or why it can't be; then nothing is read."""
        place = self._place
        try:
            return way()
        except GologError as error:
            self._place = place
            return error

    def nested(self, way: Callable[[], Read]) -> Read:
        """Read one level deeper."""
        if self._depth >= DEPTH:
            raise self.fault(self.next, f"more than {DEPTH} levels within each other", "make procedures of some")
        self._depth += 1
        try:
            return way()
        finally:
            self._depth -= 1

    # ---- terms -----------------------------------------------------------------------------------------------------

    def term(self) -> Term:
        """Read a term with its sums."""
        return self.nested(lambda: self._operations(("+", "-"), self._product))

    def _product(self) -> Term:
        return self._operations(("*", "/", "\\"), self._factor)

    def _operations(self, signs: Tuple[str, ...], operand: Callable[[], Term]) -> Term:
        found = operand()
        while self.sees(*signs):
            found = Operation(self.read(), found, operand())
        return found

    def _factor(self) -> Term:
        if self.sees("-"):
            return Operation(self.read(), None, self.nested(self._factor))
        if self.took("("):
            found = self.term()
            self.take(")", "behind a term")
            return found
        if self.next.kind == "variable":
            return Variable(self.read())
        if self.next.kind in ("number", "string"):
            return Constant(self.read())
        return self.compound("a term", "write a name, a number or a variable")

    def compound(self, what: str, mend: str) -> Compound:
        """Read a name with its arguments, if it has any; ``what`` it is and the ``mend`` are told if there is none."""
        name = self.take_kind("name", what, mend)
        arguments: List[Term] = []
        if self.took("("):
            if not self.sees(")"):
                arguments.append(self.term())
                while self.took(","):
                    arguments.append(self.term())
            self.take(")", f"behind the arguments of {name.text}")
        return Compound(name, tuple(arguments))
