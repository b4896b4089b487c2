"""Which atoms are shown: ``#show`` and ``#hide`` of a whole program, as today's ``#show`` statements.

gringo 3 shows all atoms unless they are hidden; today's solvers show all atoms only while no ``#show`` is there. What
the statements mean therefore depends on all files together, so they are collected and written at the end.
"""

import contextlib
from dataclasses import dataclass
from typing import Dict, List, Optional, Sequence, Set, Tuple

import clingo.ast

from rosoclingo.oclingo.gringo3.directive_parser import Display, Signature, signature_of
from rosoclingo.oclingo.gringo3.elements import ElementTranslator
from rosoclingo.oclingo.gringo3.lexer import RefusalError, Token
from rosoclingo.oclingo.gringo3.rewriter import Rewriting
from rosoclingo.oclingo.gringo3.syntax import Element, Function, Variable, show, show_literal

HIDDEN = "_hidden"
"""Name of the predicate that holds the single atoms that a program hides."""


@dataclass(frozen=True)
class Statement:
    """A ``#show`` or ``#hide`` with its place: the file's edits, its first token, its part's parameter."""

    rewriting: Rewriting
    translator: ElementTranslator
    token: Token
    first: int
    step: str
    display: Display
    domains: Sequence[str]


class Visibility:
    """Collects what a program shows, hides and defines, and writes it in today's terms."""

    def __init__(self) -> None:
        self._statements: List[Statement] = []
        self._defined: Dict[Signature, None] = {}
        self._in_steps: Set[Signature] = set()
        self._left: Dict[str, List[str]] = {}
        self._hides_all = False
        self._listed = False

    def define(self, signatures: Sequence[Signature], step: str) -> None:
        """Note that a part of the program, with its parameter, defines atoms of these signatures."""
        self._defined.update(dict.fromkeys(signatures))
        if step:
            self._in_steps.update(signatures)

    def leave(self, text: str, step: str) -> None:
        """Note a statement of clingo 5, which may define something; clingo is asked only if it matters."""
        self._left.setdefault(step, []).append(text)

    def _read_what_was_left(self) -> None:
        for step, texts in self._left.items():
            self.define(head_signatures("\n".join(texts)), step)

    def add(self, statement: Statement) -> None:
        """Note a ``#show`` or ``#hide``."""
        self._statements.append(statement)
        display = statement.display
        if not display.signatures and display.element is None:
            self._hides_all = not display.shows

    def write(self) -> List[Tuple[Statement, RefusalError]]:
        """Edit the files; the statements that could not be written, with the reasons."""
        if self._statements:
            self._read_what_was_left()
        refused = []
        for statement in self._statements:
            try:
                text = self._text(statement)
            except RefusalError as refusal:
                refused.append((statement, refusal))
                continue
            if text is not None:
                statement.rewriting.replace((statement.first, statement.display.dot + 1), text)
        return refused

    def _text(self, statement: Statement) -> Optional[str]:
        """Today's text of a statement, or None if it can stay."""
        display = statement.display
        if display.element is None or whole_predicate(display.element):
            return self._text_of_signatures(statement)
        if display.shows:
            return self._shown_atoms(statement, display.element)
        return self._hidden_atoms(statement, display.element)

    def _text_of_signatures(self, statement: Statement) -> Optional[str]:
        display = statement.display
        signatures = _signatures(display)
        if not signatures:
            return "#show." if not display.shows and self._hides_all else ""
        if self._hides_all:
            return " ".join(map(_show_signature, signatures)) if display.shows else ""
        return "" if display.shows else self._list()

    def _list(self, but: Sequence[Signature] = ()) -> str:
        """The signatures that stay visible in a program that hides some; written only once."""
        if self._listed:
            return ""
        self._listed = True
        invisible = {*self._all_signatures(False), *self._partly_hidden(), *but}
        visible = [signature for signature in self._defined if signature not in invisible]
        return " ".join(["#show.", *map(_show_signature, visible)])

    def _all_signatures(self, shows: bool) -> List[Signature]:
        return [found for s in self._statements if s.display.shows == shows for found in _signatures(s.display)]

    def _partly_hidden(self) -> List[Signature]:
        elements = (s.display.element for s in self._statements if not s.display.shows)
        return [found for element in elements if element for found in signature_of(element.literal.left)]

    def _shown_atoms(self, statement: Statement, element: Element) -> str:
        signatures = signature_of(element.literal.left)
        if not self._hides_all and not set(signatures) & set(self._all_signatures(False)):
            return ""
        if not statement.step and set(signatures) & self._in_steps:
            message = "atoms that steps define cannot be shown from the base part"
            raise RefusalError(statement.token, message, "move it to the part that defines them")
        rules = []
        for single in map(statement.translator.counted, statement.translator.elements(element)):
            atom = show(single.literal.left)
            rules.append(
                "#show {} : {}.".format(
                    atom, ", ".join([atom, *map(show_literal, single.conditions), *statement.domains])
                )
            )
        return " ".join(rules)

    def _hidden_atoms(self, statement: Statement, element: Element) -> str:
        (signature, *more) = signature_of(element.literal.left)
        if self._hides_all and signature not in self._all_signatures(True):
            return ""
        if self._hides_all or self._in_steps or more:
            message = "single atoms cannot be hidden in a program with steps or in one that hides all"
            raise RefusalError(statement.token, message, "hide the predicate as a whole, or show the atoms that remain")
        name, arity = signature
        atom = name + ("({})".format(",".join(f"X{i}" for i in range(arity))) if arity else "")
        visible = f"#show {atom} : {atom}, not {HIDDEN}({atom})."
        return " ".join([*filter(None, [self._list()]), *self._hiding_rules(statement, element), visible])

    def _hiding_rules(self, statement: Statement, element: Element) -> List[str]:
        rules = []
        for single in map(statement.translator.counted, statement.translator.elements(element)):
            atom, conditions = show(single.literal.left), [*map(show_literal, single.conditions), *statement.domains]
            body = " :- " + ", ".join([atom, *conditions])
            rules.append(f"{HIDDEN}({atom}){body}.")
        return rules


def whole_predicate(element: Element) -> List[Signature]:
    """The signature of an atom that stands for its whole predicate: without conditions, with variables as arguments."""
    literal = element.literal
    arguments = literal.left.lists[0] if isinstance(literal.left, Function) and len(literal.left.lists) == 1 else ()
    names = [term.name for term in arguments if isinstance(term, Variable) and term.name != "_"]
    only_variables = arguments and all(isinstance(term, Variable) for term in arguments)
    if element.conditions or not only_variables or len(set(names)) < len(names):
        return []
    return signature_of(literal.left)


def _signatures(display: Display) -> List[Signature]:
    return [*display.signatures, *(whole_predicate(display.element) if display.element else ())]


def _show_signature(signature: Signature) -> str:
    return "#show {}/{}.".format(*signature)


def head_signatures(text: str) -> List[Tuple[str, int]]:
    """The signatures of the atoms in the heads of statements, or declared external; clingo stops at a faulty statement.

    Only ASCII goes to clingo: its Python module ends the process when a message cuts another character in two.
    """
    found: List[Tuple[str, int]] = []
    plain = text.encode("ascii", "replace").decode("ascii")
    with contextlib.suppress(RuntimeError):  # clingo will name the fault when the program is loaded
        clingo.ast.parse_string(plain, lambda node: found.extend(_of_statement(node)), logger=lambda *message: None)
    return list(dict.fromkeys(found))


def _of_statement(node: clingo.ast.AST) -> List[Tuple[str, int]]:
    if node.ast_type is clingo.ast.ASTType.Rule:
        return _Atoms().of(node.head)
    return _Atoms().of(node.atom) if node.ast_type is clingo.ast.ASTType.External else []


class _Atoms(clingo.ast.Transformer):
    """Collects the signatures of symbolic atoms outside conditions."""

    def __init__(self) -> None:
        self._found: List[Tuple[str, int]] = []

    def of(self, node: clingo.ast.AST) -> List[Tuple[str, int]]:
        """The signatures of the atoms below a node."""
        self.visit(node)
        return self._found

    def visit_SymbolicAtom(self, node: clingo.ast.AST) -> clingo.ast.AST:
        """Note an atom; ``-p`` is a unary operation on the term ``p``."""
        negative = node.symbol.ast_type is clingo.ast.ASTType.UnaryOperation
        self._note(node.symbol.argument if negative else node.symbol, "-" if negative else "")
        return node

    def visit_ConditionalLiteral(self, node: clingo.ast.AST) -> clingo.ast.AST:
        """Look at the literal, not at its condition."""
        self.visit(node.literal)
        return node

    def _note(self, term: clingo.ast.AST, sign: str) -> None:
        if term.ast_type is clingo.ast.ASTType.Function:
            self._found.append((sign + term.name, len(term.arguments)))
        elif term.ast_type is clingo.ast.ASTType.Pool:
            for alternative in term.arguments:
                self._note(alternative, sign)
        elif term.ast_type is clingo.ast.ASTType.SymbolicTerm:
            self._found.append((sign + term.symbol.name, len(term.symbol.arguments)))
