"""Translation of ``#show`` and ``#hide``.

gringo 3 shows all atoms that are not hidden; clingo 5 shows all atoms only if there is no ``#show``. The translation
therefore depends on all files of a program.
"""

from functools import cached_property
from typing import Dict, Iterator, List, Sequence, Tuple

from clingo.ast import AST, ASTType

from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.gringo3.dialect import accepted_by_clingo
from rosoclingo.oclingo.gringo3.grammar import UntranslatableError
from rosoclingo.oclingo.gringo3.terms import Element, ProgramScope, show

Signature = Tuple[str, int]
"""Name and arity of a predicate; the name of a classically negated one begins with ``-``."""

HIDDEN = "_hidden"
"""Name of the predicate for single atoms that a program hides."""

_SHOW = "#show {}/{}."


def signature(node: SyntaxNode) -> Signature:
    """Return the signature of a node ``name/arity``."""
    return "".join(node.tokens[:-2]), int(node.tokens[-1])


def signatures_of(literal: SyntaxNode) -> List[Signature]:
    """Return the signatures of an atom; argument lists separated by ``;;`` can have different lengths."""
    term = literal.parts[0]
    sign, inner = ("-", term.parts[0]) if term.kind == "signed" else ("", term)
    return [(sign + inner.text, len(arguments.parts)) for arguments in inner.parts] or [(sign + inner.text, 0)]


class ShowStatement:
    """A ``#show`` or ``#hide``.

    Attributes:
        node: its syntax tree.
        step: the parameter of its program part, "" in base.
        domains: the atoms that ``#domain`` adds to its conditions.
        shows: whether it is a ``#show``.
        signatures: the predicates that it shows or hides as a whole.
        element: the conditional atoms that it shows or hides otherwise.

    """

    def __init__(self, node: SyntaxNode, step: str, domains: Sequence[str]) -> None:
        self.node, self.step, self.domains = node, step, domains
        self.shows = node.text == "#show"
        self.element = Element.of(node.parts[0]) if node.parts and node.parts[0].kind == "element" else None
        if self.element is None:
            self.signatures = [signature(one) for part in node.parts for one in part.parts]
        else:
            self.signatures = whole_predicate(self.element)
            self.element = None if self.signatures else self.element


class Visibility:
    """Collects the atoms that a program shows, hides and defines, and writes clingo 5's ``#show`` statements."""

    def __init__(self, scope: ProgramScope) -> None:
        self._scope = scope
        self._statements: List[ShowStatement] = []
        self._texts: List[Tuple[str, str]] = []
        self._hides_all = False
        self._listed = False

    def note(self, text: str, step: str) -> None:
        """Record a statement in clingo 5's language, whose heads are parsed only if they are needed."""
        self._texts.append((text, step))

    def add(self, statement: ShowStatement) -> None:
        """Record a ``#show`` or ``#hide``."""
        self._statements.append(statement)
        if not statement.node.parts:
            self._hides_all = not statement.shows

    @cached_property
    def _defined(self) -> Dict[Signature, bool]:
        """For each predicate in heads and ``#external`` statements, whether it occurs in steps."""
        found: Dict[Signature, bool] = {}
        for text, step in self._texts:
            for one in head_signatures(text):
                found[one] = found.get(one, False) or bool(step)
        return found

    def text(self, statement: ShowStatement) -> str:
        """Return the translation of a statement, after all statements of the program were recorded.

        Raises :class:`UntranslatableError`.
        """
        if statement.element is not None:
            return (self._shown_atoms if statement.shows else self._hidden_atoms)(statement, statement.element)
        if not statement.node.parts:
            return "#show." if not statement.shows and self._hides_all else ""
        if self._hides_all:
            return " ".join(_SHOW.format(*one) for one in statement.signatures) if statement.shows else ""
        return "" if statement.shows else self._list()

    def _list(self) -> str:
        """Return ``#show`` statements for all predicates that are not hidden, "" after the first call."""
        if self._listed:
            return ""
        self._listed = True
        elements = [one.element for one in self._statements if not one.shows and one.element is not None]
        partly = [found for element in elements for found in signatures_of(element.literal)]
        invisible = {*self._all_signatures(False), *partly}
        return " ".join(["#show.", *(_SHOW.format(*one) for one in self._defined if one not in invisible)])

    def _all_signatures(self, shows: bool) -> List[Signature]:
        return [found for one in self._statements if one.shows == shows for found in one.signatures]

    def _shown_atoms(self, statement: ShowStatement, element: Element) -> str:
        signatures = signatures_of(element.literal)
        if not self._hides_all and not set(signatures) & set(self._all_signatures(False)):
            return ""
        if not statement.step and any(self._defined.get(one) for one in signatures):
            message = "the base part cannot show atoms that steps define"
            raise UntranslatableError(statement.node, message, "move it to the part that defines them")
        return " ".join(f"#show {atom} : {body}." for atom, body in self._singles(statement, element))

    def _hidden_atoms(self, statement: ShowStatement, element: Element) -> str:
        (signature, *more) = signatures_of(element.literal)
        if self._hides_all and signature not in self._all_signatures(True):
            return ""
        if self._hides_all or any(self._defined.values()) or more:
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
        singles = [single.counted(self._scope) for single in element.singles()]
        return [(show(one.literal), ", ".join([*map(show, one.literals), *statement.domains])) for one in singles]


def whole_predicate(element: Element) -> List[Signature]:
    """Return the signature of an atom without conditions whose arguments are distinct variables, else []."""
    lists = element.literal.parts[0].parts
    arguments = lists[0].parts if len(lists) == 1 and lists[0].kind == "list" else []
    names = [term.text for term in arguments if term.kind == "variable" and term.text != "_"]
    if element.conditions or not arguments or len(set(names)) < len(names):
        return []
    return signatures_of(element.literal) if all(term.kind == "variable" for term in arguments) else []


def head_signatures(text: str) -> List[Signature]:
    """Return the signatures of atoms in heads and ``#external`` statements, up to the first syntax error."""
    found: List[Signature] = []

    def collect(statement: AST) -> None:
        if statement.ast_type in (ASTType.Rule, ASTType.External):
            head = statement.head if statement.ast_type == ASTType.Rule else statement.atom
            found.extend(signature for atom in _atoms(head) for signature in _signatures_of_term(atom.symbol))

    accepted_by_clingo(text, collect)  # the loader reports errors
    return found


def _atoms(node: AST) -> Iterator[AST]:
    """Yield the atoms of a head, without those of conditions."""
    if node.ast_type == ASTType.SymbolicAtom:
        yield node
    for key in ["literal"] if node.ast_type == ASTType.ConditionalLiteral else node.child_keys:
        child = getattr(node, key)
        for one in (child,) if isinstance(child, AST) else child or ():
            yield from _atoms(one)


def _signatures_of_term(term: AST, sign: str = "") -> Iterator[Signature]:
    """Yield the signatures of an atom's term, one for each alternative of a pool."""
    if term.ast_type == ASTType.UnaryOperation:
        yield from _signatures_of_term(term.argument, "-")
    elif term.ast_type == ASTType.Pool:
        for alternative in term.arguments:
            yield from _signatures_of_term(alternative, sign)
    else:
        of = term if term.ast_type == ASTType.Function else term.symbol
        yield sign + of.name, len(of.arguments)
