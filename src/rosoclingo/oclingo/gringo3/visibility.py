"""Translation of ``#show`` and ``#hide``.

gringo 3 shows all atoms that are not hidden; clingo 5 shows all atoms only if there is no ``#show``. The translation
therefore depends on all files of a program: it collects the statements and writes them at the end.
"""

import contextlib
from typing import Dict, List, NamedTuple, Optional, Sequence, Set, Tuple

from clingo.ast import AST, ASTType, Transformer, parse_string

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.gringo3.grammar import UntranslatableError
from rosoclingo.oclingo.gringo3.rewriter import Rewriting
from rosoclingo.oclingo.gringo3.terms import Element, Naming, show

Signature = Tuple[str, int]
"""Name and arity of a predicate; the name of a classically negated one begins with ``-``."""

HIDDEN = "_hidden"
"""Name of the predicate for single atoms that a program hides."""


def signature(node: SyntaxNode) -> Signature:
    """Return the signature of a node ``name/arity``."""
    return "".join(node.tokens[:-2]), int(node.tokens[-1])


def signatures_of(literal: SyntaxNode) -> List[Signature]:
    """Return the signatures of an atom; argument lists separated by ``;;`` can have different lengths."""
    term = literal.parts[0]
    sign, inner = ("-", term.parts[0]) if term.kind == "signed" else ("", term)
    return [(sign + inner.text, len(arguments.parts)) for arguments in inner.parts] or [(sign + inner.text, 0)]


class ShowStatement(NamedTuple):
    """A ``#show`` or ``#hide`` with its file, the file's faults and edits, its token range and its part's parameter."""

    file: str
    faults: List[Fault]
    rewriting: Rewriting
    place: Tuple[int, int]
    step: str
    node: SyntaxNode
    domains: Sequence[str]

    @property
    def shows(self) -> bool:
        """Whether the statement is a ``#show``."""
        return self.node.text == "#show"

    @property
    def element(self) -> Optional[Element]:
        """The conditional atoms of the statement, None if it names signatures."""
        node = self.node.parts[0] if self.node.parts else None
        return Element.of(node) if node is not None and node.kind == "element" else None

    @property
    def signatures(self) -> List[Signature]:
        """The predicates that the statement shows or hides as a whole."""
        if self.element is not None:
            return whole_predicate(self.element)
        return [signature(one) for part in self.node.parts for one in part.parts]

    @property
    def is_of_all(self) -> bool:
        """Whether the statement shows or hides all atoms."""
        return not self.node.parts


class Visibility:
    """Collects the atoms that a program shows, hides and defines, and writes clingo 5's ``#show`` statements."""

    def __init__(self, naming: Naming) -> None:
        self._naming = naming
        self._statements: List[ShowStatement] = []
        self._defined: Dict[Signature, None] = {}
        self._in_steps: Set[Signature] = set()
        self._texts: List[Tuple[str, str]] = []
        self._hides_all = False
        self._listed = False

    def note(self, text: str, step: str) -> None:
        """Record a statement in clingo 5's language, whose heads are parsed only if they are needed."""
        self._texts.append((text, step))

    def add(self, statement: ShowStatement) -> None:
        """Record a ``#show`` or ``#hide``."""
        self._statements.append(statement)
        if statement.is_of_all:
            self._hides_all = not statement.shows

    def write(self) -> None:
        """Edit the files; add statements that cannot be translated to the faults of their files."""
        for text, step in self._texts if self._statements else ():
            found = head_signatures(text)
            self._defined.update(dict.fromkeys(found))
            self._in_steps.update(found if step else ())
        for statement in self._statements:
            try:
                statement.rewriting.replace(*statement.place, self._text(statement))
            except UntranslatableError as refusal:
                statement.faults.append(refusal.fault(statement.file))

    def _text(self, statement: ShowStatement) -> str:
        """Return the translation of a statement."""
        element, signatures = statement.element, statement.signatures
        if element is not None and not signatures:
            return (self._shown_atoms if statement.shows else self._hidden_atoms)(statement, element)
        if statement.is_of_all:
            return "#show." if not statement.shows and self._hides_all else ""
        if self._hides_all:
            return " ".join(map(_show_signature, signatures)) if statement.shows else ""
        return "" if statement.shows else self._list()

    def _list(self) -> str:
        """Return ``#show`` statements for all predicates that are not hidden, "" after the first call."""
        if self._listed:
            return ""
        self._listed = True
        elements = [one.element for one in self._statements if not one.shows and one.element]
        partly = [found for element in elements for found in signatures_of(element.literal)]
        invisible = {*self._all_signatures(False), *partly}
        visible = [signature for signature in self._defined if signature not in invisible]
        return " ".join(["#show.", *map(_show_signature, visible)])

    def _all_signatures(self, shows: bool) -> List[Signature]:
        return [found for one in self._statements if one.shows == shows for found in one.signatures]

    def _shown_atoms(self, statement: ShowStatement, element: Element) -> str:
        signatures = signatures_of(element.literal)
        if not self._hides_all and not set(signatures) & set(self._all_signatures(False)):
            return ""
        if not statement.step and set(signatures) & self._in_steps:
            message = "the base part cannot show atoms that steps define"
            raise UntranslatableError(statement.node, message, "move it to the part that defines them")
        return " ".join(f"#show {atom} : {body}." for atom, body in self._singles(statement, element))

    def _hidden_atoms(self, statement: ShowStatement, element: Element) -> str:
        (signature, *more) = signatures_of(element.literal)
        if self._hides_all and signature not in self._all_signatures(True):
            return ""
        if self._hides_all or self._in_steps or more:
            message = "single atoms cannot be hidden in a program with steps or in one that hides all"
            remedy = "hide the predicate as a whole, or show the atoms that remain"
            raise UntranslatableError(statement.node, message, remedy)
        name, arity = signature
        atom = name + ("({})".format(",".join(f"X{i}" for i in range(arity))) if arity else "")
        rules = [f"{HIDDEN}({hidden}) :- {body}." for hidden, body in self._singles(statement, element)]
        visible = f"#show {atom} : {atom}, not {HIDDEN}({atom})."
        return " ".join([*filter(None, [self._list()]), *rules, visible])

    def _singles(self, statement: ShowStatement, element: Element) -> List[Tuple[str, str]]:
        """Return each atom of a statement with its condition."""
        singles = [single.counted(self._naming) for single in element.singles()]
        return [(show(one.literal), ", ".join([*map(show, one.literals), *statement.domains])) for one in singles]


def whole_predicate(element: Element) -> List[Signature]:
    """Return the signature of an atom without conditions whose arguments are distinct variables, else []."""
    lists = element.literal.parts[0].parts
    arguments = lists[0].parts if len(lists) == 1 and lists[0].kind == "list" else []
    names = [term.text for term in arguments if term.kind == "variable" and term.text != "_"]
    only_variables = arguments and all(term.kind == "variable" for term in arguments)
    return (
        []
        if element.conditions or not only_variables or len(set(names)) < len(names)
        else signatures_of(element.literal)
    )


def _show_signature(signature: Signature) -> str:
    return "#show {}/{}.".format(*signature)


def head_signatures(text: str) -> List[Signature]:
    """Return the signatures of atoms in heads and ``#external`` statements, up to the first syntax error.

    The text is converted to ASCII: clingo's module aborts the process if a message cuts a longer character.
    """
    atoms = _Atoms()
    plain = text.encode("ascii", "replace").decode("ascii")
    with contextlib.suppress(RuntimeError):  # the loader reports the error
        parse_string(plain, atoms.collect, logger=lambda code, message: None)
    return list(atoms.found)


class _Atoms(Transformer):
    """Collects the signatures of the atoms that statements define or declare."""

    def __init__(self) -> None:
        self.found: Dict[Signature, None] = {}

    def collect(self, statement: AST) -> None:
        """Collect the signatures of a statement."""
        if statement.ast_type in (ASTType.Rule, ASTType.External):
            self.visit(statement.head if statement.ast_type == ASTType.Rule else statement.atom)

    def visit_SymbolicAtom(self, node: AST) -> AST:
        """Record an atom."""
        self._note(node.symbol, "")
        return node

    def visit_ConditionalLiteral(self, node: AST) -> AST:
        """Visit the literal, not its condition."""
        self.visit(node.literal)
        return node

    def _note(self, term: AST, sign: str) -> None:
        if term.ast_type == ASTType.UnaryOperation:
            self._note(term.argument, "-")
        elif term.ast_type == ASTType.Pool:
            for alternative in term.arguments:
                self._note(alternative, sign)
        else:
            of = term if term.ast_type == ASTType.Function else term.symbol
            self.found[sign + of.name, len(of.arguments)] = None
