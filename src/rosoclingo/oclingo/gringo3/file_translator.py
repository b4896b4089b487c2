"""Translates the files of a program, of which some are in gringo 3's language, statement by statement."""

from pathlib import PurePath
from typing import Callable, Dict, List, Sequence, Set, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.grammars import Node
from rosoclingo.oclingo.gringo3.dialect import Dialect, FileDialect, StatementDialect
from rosoclingo.oclingo.gringo3.grammar import RefusalError, aggregate_of, parse
from rosoclingo.oclingo.gringo3.lexer import Kind, Token, TranslationError
from rosoclingo.oclingo.gringo3.optimization import OptimizationTranslator
from rosoclingo.oclingo.gringo3.rewriter import Rewriting, domain_atoms
from rosoclingo.oclingo.gringo3.rules import RuleTranslator
from rosoclingo.oclingo.gringo3.terms import Element, Naming, alternatives, has_interval, has_pool, show
from rosoclingo.oclingo.gringo3.visibility import Statement, Visibility, signature, signatures_of

_ARITHMETIC = {"+", "-", "*", "/", "\\", "**", "..", "&", "^", "?", "~", "|", "#mod", "#div", "#pow"}
_COMPARISONS = {"=", ":=", "==", "!=", "<", "<=", ">", ">="}


class Constants:
    """Records where names are used as terms before ``#const`` gives them a value.

    gringo 3 replaces a constant only in what follows, today's solver everywhere.
    """

    def __init__(self) -> None:
        self._used: Dict[str, Tuple[str, Token]] = {}

    def note(self, file: str, statement: Sequence[Token]) -> None:
        """Note the names that a statement uses as terms.

        Names inside arithmetic do not count: there gringo 3 stops at a name without a value, so that no program can
        mean anything else than today's solver takes it for.
        """
        for token in _names(statement):
            self._used.setdefault(token.text, (file, token))

    def define(self, const: Node, name: str) -> None:
        """Note a ``#const``; :class:`RefusalError` if a statement before it uses the name."""
        if name in self._used:
            file, use = self._used[name]
            message = f"gringo 3 does not replace '{name}' in the statements before this #const, but clingo 5 does"
            raise RefusalError(const, message, f"put the #const before its use in {file}:{use.line}")


def _names(statement: Sequence[Token]) -> List[Token]:
    found, depth = [], 0
    for before, token, after in zip(("", *(t.text for t in statement)), statement, (*statement[1:], statement[-1])):
        depth += {"(": 1, ")": -1}.get(token.text, 0)
        around = {before, after.text}
        is_term = depth > 0 or around & _COMPARISONS
        if token.kind is Kind.IDENTIFIER and after.text != "(" and is_term and not around & _ARITHMETIC:
            found.append(token)
    return found


class Program:
    """What reaches from file to file: ``#domain``, ``#show`` and ``#hide``, constants, the order of optimization."""

    def __init__(self, naming: Naming) -> None:
        self.naming = naming
        self.visibility = Visibility(naming)
        self.domains: List[Tuple[str, List[str]]] = []
        self.levels = 0
        self.constants = Constants()
        self.seen_variables: Set[str] = set()


def translated(
    files: Sequence[Tuple[str, str]],
    lexed: Sequence[Sequence[Token]],
    inspected: Sequence[FileDialect],
    dialects: Sequence[Dialect],
) -> List[Tuple[str, Tuple[str, ...]]]:
    """Return the translation of each file, and the warnings about it; raises TranslationError."""
    program = Program(Naming(token.text for found in lexed for token in found if token.kind is Kind.VARIABLE))
    translators = [
        FileTranslator(program, name, text, found, evidence, dialect)
        for (name, text), found, evidence, dialect in zip(files, lexed, inspected, dialects)
    ]
    faults = [fault for translator in translators for fault in translator.run()] + program.visibility.write()
    if faults:
        raise TranslationError(faults)
    return [(one.rewriting.result(), tuple(one.warnings)) for one in translators]


class FileTranslator:
    """Translates one file of a program; files have to be run in order."""

    def __init__(
        self, program: Program, name: str, text: str, tokens: Sequence[Token], evidence: FileDialect, dialect: Dialect
    ) -> None:
        self._program, self._tokens, self._evidence, self._dialect = program, tokens, evidence, dialect
        self._text, self._name, self._file = text, name, PurePath(name).name
        self.rewriting = Rewriting(text, tokens)
        self.warnings: List[str] = []
        self._rules = RuleTranslator(self.rewriting, program.naming)
        self._optimization = OptimizationTranslator(self.rewriting, program.naming, self._file)
        self._step = ""
        self._has_gringo3 = bool(evidence.of(Dialect.GRINGO3))

    def run(self) -> List[Fault]:
        """Translate all statements; what could not be translated."""
        faults = []
        for statement in self._evidence.statements:
            try:
                self._statement(statement)
            except RefusalError as refusal:
                faults.append(refusal.fault(self._name))
        return faults

    def _statement(self, statement: StatementDialect) -> None:
        tokens = self._tokens[statement.first : statement.after]
        if not self._is_gringo3(statement.dialect):
            self._leave(tokens)
            return
        ends = tokens[-1].text == "." or (tokens[0].text, tokens[-1].text) == (":~", ">")
        if not ends and tokens[0].kind is not Kind.SCRIPT:
            raise RefusalError(tokens[-1], "this statement has no dot at its end")
        node = parse(self._tokens, statement.first, statement.after)
        if node.kind in _TRANSLATIONS:
            _TRANSLATIONS[node.kind](self, node)
        if node.kind != "const":
            self._program.constants.note(self._file, tokens)
        self._program.seen_variables.update(token.text for token in tokens if token.kind is Kind.VARIABLE)

    def _is_gringo3(self, statement: Dialect) -> bool:
        """Whether a statement counts as gringo 3's; its own evidence weighs more than the file's language."""
        if self._evidence.pragma is Dialect.CLINGO5 or statement is Dialect.CLINGO5:
            return False
        mixed = statement is Dialect.EITHER and self._has_gringo3
        return self._dialect is Dialect.GRINGO3 or statement is Dialect.GRINGO3 or mixed

    def _leave(self, tokens: Sequence[Token]) -> None:
        """Leave a statement of clingo 5 as it is."""
        if tokens[0].text == "#program":
            self._step = tokens[3].text if len(tokens) > 5 and tokens[2].text == "(" else ""
        if domain_atoms(tokens, self._program.domains):
            message = "a variable that #domain declares cannot stand in a statement of clingo 5"
            raise RefusalError(tokens[0], message, "use another variable")
        self._program.visibility.leave(self._text[tokens[0].start : tokens[-1].end], self._step)

    def _domains(self, node: Node) -> List[str]:
        return domain_atoms(self.rewriting.tokens_of(node), self._program.domains)

    def _rule(self, rule: Node) -> None:
        self._rules.translate(rule, self._domains(rule))
        heads = [part for part in rule.parts if part.kind != "body"][:1]
        literals = [one for head in heads for one in ([head] if head.kind == "literal" else _literals(head))]
        literals = [one for one in literals if one.kind == "literal" and one.children[0] != "not"]
        self._program.visibility.define([found for one in literals for found in signatures_of(one)], self._step)

    def _weak(self, weak: Node) -> None:
        names = self._rules.weak_body(weak, self._domains(weak))
        self._optimization.weak(weak, weak.span[1], self._step, names)

    def _part(self, part: Node) -> None:
        """Begin a part; the name behind its directive is its parameter, or in brackets behind today's name."""
        names = [token for token in part.tokens if token.type == "IDENTIFIER"]
        self._step = str(names[-1]) if len(names) > (part.kind == "program") else ""
        self._terms(part)

    def _terms(self, directive: Node) -> None:
        for term in directive.parts:
            if self.rewriting.is_special(term):
                self.rewriting.put(term, show(term))

    def _const(self, const: Node) -> None:
        term, name = const.parts[0], str(const.tokens[1])
        if has_pool(term) or has_interval(term):
            message = "a constant of a pool or a range cannot be translated"
            raise RefusalError(const, message, f"write {show(term)} in place of {name}")
        if any(part.kind == "variable" for part in term.walk()):
            raise RefusalError(const, "a constant cannot hold a variable")
        self._program.constants.define(const, name)
        self._terms(const)

    def _domain(self, domain: Node) -> None:
        literal = domain.parts[0]
        atom = literal.parts[0].parts[0] if literal.parts[0].kind == "signed" else literal.parts[0]
        terms = atom.parts[0].parts if atom.parts else []
        if not terms or any(term.kind != "variable" or term.text == "_" for term in terms):
            raise RefusalError(literal, "#domain takes an atom whose arguments are variables")
        variables = [term.text for term in terms]
        early = [variable for variable in variables if variable in self._program.seen_variables]
        if early:
            message = f"#domain does not reach the statements above it that use {', '.join(early)}"
            self.warnings.append(f"{self._name}:{domain.line}:{domain.column}: {message}")
        self._program.domains.append((show(literal), variables))
        self.rewriting.put(domain, "")

    def _display(self, display: Node) -> None:
        self._program.visibility.add(
            Statement(self._name, self.rewriting, self._step, display, self._domains(display)),
        )

    def _external(self, external: Node) -> None:
        declared = external.parts[0]
        if declared.kind == "signature":
            self._program.visibility.define([signature(declared)], self._step)
            return
        element = Element.of(declared)
        self._program.visibility.define(signatures_of(element.literal), self._step)
        conditions = tuple(found for condition in element.conditions for found in alternatives(condition))
        if self.rewriting.is_special(declared):
            self.rewriting.put(declared, str(element._replace(conditions=conditions)))
        else:
            self._rules.chain(declared)
        domains = self._domains(declared)
        if domains:
            joint = ", " if conditions else " : "
            self.rewriting.insert(declared.span[1], joint + ", ".join(domains))

    def _optimize(self, statement: Node) -> None:
        self._optimization.optimize(statement, self._program.levels, self._step, self._program.domains)
        self._program.levels += 1

    def _compute(self, statement: Node) -> None:
        self._optimization.compute(statement, self._program.domains)


_TRANSLATIONS: Dict[str, Callable[[FileTranslator, Node], None]] = {
    "rule": FileTranslator._rule,
    "weak": FileTranslator._weak,
    **dict.fromkeys(("base", "program", "part"), FileTranslator._part),
    **dict.fromkeys(("forget", "iinit"), FileTranslator._terms),
    "const": FileTranslator._const,
    "domain": FileTranslator._domain,
    "display": FileTranslator._display,
    "external": FileTranslator._external,
    "optimize": FileTranslator._optimize,
    "compute": FileTranslator._compute,
}


def _literals(head: Node) -> List[Node]:
    """The literals of a disjunction or an aggregate, without their conditions."""
    elements = aggregate_of(head).core.parts if head.kind == "aggregate" else head.parts
    return [Element.of(element).literal for element in elements]
