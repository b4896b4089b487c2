"""An index of a program's statements for checks: where each predicate is defined, declared, used and shown."""

import re
from typing import Dict, Iterable, List, Mapping, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.directives import OpenExternal
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Occurrence, Part
from rosoclingo.oclingo.program.signatures import evaluate
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.progression.terms import Signature

OWN = "__oclingo"
"""Prefix of the names of rosoclingo's internal predicates."""

GENERATED = ("<program>", "<string>")
"""File names of statements that rosoclingo adds to a program."""

_BRACKETS = re.compile(r"\(([^(),]*[-+*/][^(),]*)\)(?=[,)])")
_ANONYMOUS = re.compile(r"\bAny__[0-9]+\b")

LABELS = "~labels"
"""File name of the facts with which the core passes its labels to a program."""


def term_text(term: Node) -> str:
    """Return the term as text, without clingo's brackets around sums and with ``_`` for anonymous variables."""
    return _ANONYMOUS.sub("_", _BRACKETS.sub(r"\1", str(term)))


def shows(statement: Node) -> bool:
    """Return whether a statement is a ``#show``."""
    return statement.ast_type in (ASTType.ShowSignature, ASTType.ShowTerm)


def label_facts(labels: Iterable[str]) -> Source:
    """Return the facts about labels that the core adds to a program."""
    return Source(LABELS, "".join(f"label({label}).\n" for label in labels))


class Survey:
    """An index of the statements of a program, without those that rosoclingo adds.

    Attributes:
        parts: the program's parts.
        constants: the values of its constants.
        opened: the predicates of ``#external p/n.``, each with its place.
        statements: the statements with their parts and atoms.
        defining: for each predicate, its atoms in heads of rules.
        declaring: for each predicate, its atoms in ``#external`` statements.
        using: for each predicate, its other atoms.
        shown: the predicates of ``#show p/n.``, each with its statement.
        shows: whether there is any ``#show``; otherwise all atoms are shown.
        unvalued: constants with a definition but without a known value.
        silenced: the predicates of ``#defined p/n.``

    """

    def __init__(
        self, parts: Sequence[Part], constants: Mapping[str, clingo.Symbol], opened: Sequence[OpenExternal] = ()
    ) -> None:
        self.parts, self.constants = parts, dict(constants)
        self.opened: Dict[Signature, OpenExternal] = {one.signature: one for one in opened}
        self.statements: List[Tuple[Part, Node, List[Occurrence]]] = []
        self.defining: Dict[Signature, List[Occurrence]] = {}
        self.declaring: Dict[Signature, List[Occurrence]] = {}
        self.using: Dict[Signature, List[Occurrence]] = {}
        self.shown: Dict[Signature, Node] = {}
        self.silenced: Set[Signature] = set()
        self.unvalued: Set[str] = set()
        self.shows = False
        for part in parts:
            for statement, found in part.found:
                if statement.location.begin.filename not in GENERATED:
                    self._add_statement(part, statement, found)

    def _add_statement(self, part: Part, statement: Node, found: List[Occurrence]) -> None:
        self.statements.append((part, statement, found))
        kind = statement.ast_type
        self.shows |= shows(statement)
        if kind == ASTType.ShowSignature and statement.name:  # "#show." has no name
            self.shown.setdefault(Signature(statement.name, statement.arity, bool(statement.positive)), statement)
        if kind == ASTType.Definition and statement.name not in self.constants:
            self.unvalued.add(statement.name)
        if kind == ASTType.Defined:
            self.silenced.add(Signature(statement.name, statement.arity, bool(statement.positive)))
        for one in found:
            if not one.signature.name.startswith(OWN):
                where = self.defining if one.defines else self.declaring if one.declares else self.using
                where.setdefault(one.signature, []).append(one)

    def number(self, term: Node) -> Optional[int]:
        """Return the number that a ground term denotes, None for any other term."""
        value = evaluate(term, self.constants)
        return value.number if value is not None and value.type is clingo.SymbolType.Number else None

    @property
    def known(self) -> Set[Signature]:
        """The predicates that a rule or an external can make true."""
        return {*self.defining, *self.declaring, *self.opened}

    def is_external(self, signature: Signature) -> bool:
        """Return whether the program declares externals of the predicate."""
        return signature in self.declaring or signature in self.opened

    @property
    def first_file(self) -> str:
        """The first file of the program."""
        return str(self.parts[0].header.location.begin.filename) if self.parts else "<program>"
