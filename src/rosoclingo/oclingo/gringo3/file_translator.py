"""Translates the statements of one file, and holds what reaches from file to file."""

from typing import Callable, Dict, List, Sequence, Set, Tuple

from rosoclingo.oclingo.gringo3.aggregates import OptimizationTranslator, domain_atoms
from rosoclingo.oclingo.gringo3.dialect import Dialect, FileDialect, StatementDialect
from rosoclingo.oclingo.gringo3.directive_parser import DirectiveParser, Display, Signature, TermDirective, signature_of
from rosoclingo.oclingo.gringo3.elements import ElementTranslator, Naming, show_element
from rosoclingo.oclingo.gringo3.lexer import Kind, RefusalError, Token
from rosoclingo.oclingo.gringo3.rewriter import Rewriting
from rosoclingo.oclingo.gringo3.rules import RuleTranslator
from rosoclingo.oclingo.gringo3.statement_parser import FUNCTIONS
from rosoclingo.oclingo.gringo3.syntax import (
    Aggregate,
    Disjunction,
    Element,
    Rule,
    Variable,
    has_interval,
    has_pool,
    show,
    walk,
)
from rosoclingo.oclingo.gringo3.visibility import Statement, Visibility

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

    def define(self, token: Token, name: str) -> None:
        """Note a ``#const``; :class:`RefusalError` if a statement before it uses the name."""
        if name in self._used:
            file, use = self._used[name]
            message = f"gringo 3 does not replace '{name}' in the statements before this #const, but clingo 5 does"
            raise RefusalError(token, message, f"put the #const before its use in {file}:{use.line}")


def _names(statement: Sequence[Token]) -> List[Token]:
    found, depth = [], 0
    for before, token, after in zip(("", *(t.text for t in statement)), statement, (*statement[1:], statement[-1])):
        depth += {"(": 1, ")": -1}.get(token.text, 0)
        around = {before, after.text}
        is_term = depth > 0 or around & _COMPARISONS
        if token.kind is Kind.IDENTIFIER and after.text != "(" and is_term and not around & _ARITHMETIC:
            found.append(token)
    return found


_AGGREGATES = (*FUNCTIONS, "#true", "#false", "#abs", "#mod", "#div", "#pow", "#infimum", "#supremum")
_LPARSE_WORDS = ("minimize", "minimise", "maximize", "maximise", "compute", "const", "hide", "show", "domain")


class Program:
    """What reaches from file to file: ``#domain``, ``#show`` and ``#hide``, constants, the order of optimization."""

    def __init__(self, naming: Naming) -> None:
        self.naming = naming
        self.visibility = Visibility()
        self.domains: List[Tuple[str, List[str]]] = []
        self.levels = 0
        self.constants = Constants()
        self.seen_variables: Set[str] = set()


class FileTranslator:
    """Translates one file of a program; files have to be run in order."""

    def __init__(
        self, program: Program, name: str, text: str, tokens: Sequence[Token], told: FileDialect, dialect: Dialect
    ) -> None:
        self._program, self._tokens, self._told, self._dialect = program, tokens, told, dialect
        self.rewriting = Rewriting(text, tokens)
        self.warnings: List[Tuple[Token, str]] = []
        self._elements = ElementTranslator(tokens, program.naming)
        self._rules = RuleTranslator(tokens, self.rewriting, program.naming)
        self._optimization = OptimizationTranslator(tokens, self.rewriting, program.naming, name)
        self._text, self._name = text, name
        self._step = ""
        self._has_gringo3 = bool(told.of(Dialect.GRINGO3))

    def text(self) -> str:
        """The file after all edits."""
        return self.rewriting.result()

    def run(self) -> List[RefusalError]:
        """Translate all statements; what could not be translated."""
        refusals = []
        for statement in self._told.statements:
            try:
                self._statement(statement)
            except RefusalError as refusal:
                refusals.append(refusal)
        return refusals

    def _statement(self, statement: StatementDialect) -> None:
        tokens = self._tokens[statement.first : statement.after]
        if not self._is_gringo3(statement.dialect):
            self._leave(statement, tokens)
            return
        if tokens[0].kind is Kind.SCRIPT:
            raise RefusalError(tokens[0], "scripts cannot be translated", "state what the script computes as facts")
        if tokens[-1].text != "." and (tokens[0].text, tokens[-1].text) != (":~", ">"):
            raise RefusalError(tokens[-1], "this statement has no dot at its end")
        parser = DirectiveParser(self._tokens, statement.first, statement.after)
        try:
            self._parsed(statement, tokens[0], parser)
        except RefusalError as refusal:
            raise _with_mend(refusal, tokens[0]) from None
        if tokens[0].text != "#const":
            self._program.constants.note(self._name, tokens)
        self._program.seen_variables.update(token.text for token in tokens if token.kind is Kind.VARIABLE)

    def _is_gringo3(self, statement: Dialect) -> bool:
        """Whether a statement counts as gringo 3's; its own evidence weighs more than the file's language."""
        if self._told.pragma is Dialect.CLINGO5 or statement is Dialect.CLINGO5:
            return False
        mixed = statement is Dialect.EITHER and self._has_gringo3
        return self._dialect is Dialect.GRINGO3 or statement is Dialect.GRINGO3 or mixed

    def _parsed(self, statement: StatementDialect, word: Token, parser: DirectiveParser) -> None:
        if word.text in _LPARSE_WORDS and self._tokens[statement.first + 1].text in ("[", "{"):
            raise RefusalError(word, f"'{word.text}' before an aggregate is no number")
        if word.text == ":~":
            self._weak(statement, parser)
        elif word.kind is not Kind.DIRECTIVE or word.text in _AGGREGATES:
            self._rule(statement, parser)
        elif word.text in self._directives():
            parser.step()
            self._directives()[word.text](statement, parser)
        else:
            raise RefusalError(word, f"'{word.text}' is no directive of gringo 3")

    def _leave(self, statement: StatementDialect, tokens: Sequence[Token]) -> None:
        """Leave a statement of clingo 5 as it is."""
        if tokens[0].text == "#program":
            self._step = tokens[3].text if len(tokens) > 5 and tokens[2].text == "(" else ""
        if domain_atoms(tokens, self._program.domains):
            message = "a variable that #domain declares cannot stand in a statement of clingo 5"
            raise RefusalError(tokens[0], message, "use another variable")
        self._program.visibility.leave(self._text[tokens[0].start : tokens[-1].end], self._step)

    def _directives(self) -> "Dict[str, Callable[[StatementDialect, DirectiveParser], None]]":
        return {
            "#base": self._part,
            "#program": self._named_part,
            "#cumulative": self._part,
            "#volatile": self._part,
            "#forget": lambda s, p: self._terms(p.term_directive(True, ":")),
            "#iinit": lambda s, p: self._terms(p.term_directive(False, "")),
            "#const": self._const,
            "#include": lambda s, p: p.include(),
            "#domain": self._domain,
            "#show": lambda s, p: self._display(s, p.display(True)),
            "#hide": lambda s, p: self._display(s, p.display(False)),
            "#external": lambda s, p: self._external(p),
            "#compute": lambda s, p: self._optimization.compute(s.first, p.compute(), self._program.domains),
            **dict.fromkeys(("#minimize", "#minimise", "#maximize", "#maximise"), self._optimize),
        }

    def _rule(self, statement: StatementDialect, parser: DirectiveParser) -> None:
        rule = parser.rule()
        tokens = self._tokens[statement.first : statement.after]
        self._rules.translate(statement.first, rule, domain_atoms(tokens, self._program.domains))
        self._program.visibility.define(_head_signatures(rule), self._step)

    def _weak(self, statement: StatementDialect, parser: DirectiveParser) -> None:
        weak = parser.weak_constraint()
        tokens = self._tokens[statement.first : statement.after]
        found = self._rules.weak_body(weak.body, weak.dot, domain_atoms(tokens, self._program.domains))
        self._optimization.weak(weak, statement.after, self._step, found)

    def _part(self, statement: StatementDialect, parser: DirectiveParser) -> None:
        if self._tokens[statement.first].text == "#base":
            parser.dot()
            self._step = ""
            return
        directive = parser.term_directive(True, ":")
        self._terms(directive)
        self._step = directive.identifier

    def _named_part(self, statement: StatementDialect, parser: DirectiveParser) -> None:
        self._step = parser.part()

    def _terms(self, directive: TermDirective) -> None:
        first, after = directive.span
        if directive.term and self._rules.special(first, after):
            self.rewriting.replace(directive.span, show(directive.term))

    def _const(self, statement: StatementDialect, parser: DirectiveParser) -> None:
        directive = parser.term_directive(True, "=")
        if directive.term is None:
            raise RefusalError(self._tokens[statement.first], "#const needs a value", "write '#const name = value.'")
        if has_pool(directive.term) or has_interval(directive.term):
            raise RefusalError(
                self._tokens[statement.first],
                "a constant of a pool or a range cannot be translated",
                f"write {show(directive.term)} in place of {directive.identifier}",
            )
        if any(isinstance(part, Variable) for part in walk(directive.term)):
            raise RefusalError(self._tokens[statement.first], "a constant cannot hold a variable")
        self._program.constants.define(self._tokens[statement.first], directive.identifier)
        self._terms(directive)

    def _domain(self, statement: StatementDialect, parser: DirectiveParser) -> None:
        atom, variables = parser.domain()
        token = self._tokens[statement.first]
        early = [variable for variable in variables if variable in self._program.seen_variables]
        if early:
            message = "#domain does not reach the statements above it that use {}".format(", ".join(early))
            self.warnings.append((token, message))
        self._program.domains.append((atom, variables))
        self.rewriting.replace((statement.first, statement.after), "")

    def _display(self, statement: StatementDialect, display: Display) -> None:
        span = display.element.span if display.element else (0, 0)
        domains = domain_atoms(self._tokens[span[0] : span[1]], self._program.domains)
        token = self._tokens[statement.first]
        self._program.visibility.add(
            Statement(self.rewriting, self._elements, token, statement.first, self._step, display, domains)
        )

    def _external(self, parser: DirectiveParser) -> None:
        found = parser.external()
        if not isinstance(found, Element):
            self._program.visibility.define([found], self._step)
            return
        self._program.visibility.define(signature_of(found.literal.left), self._step)
        self._conditioned(found, parser.index - 1)

    def _conditioned(self, element: Element, dot: int) -> None:
        conditions = tuple(self._elements.conditions(element))
        domains = domain_atoms(self._tokens[element.span[0] : element.span[1]], self._program.domains)
        if self._rules.special(*element.span):
            self.rewriting.replace(element.span, show_element(Element(element.span, element.literal, conditions)))
        else:
            self._rules.chain(element)
        if domains:
            self.rewriting.insert(dot, (", " if conditions else " : ") + ", ".join(domains))

    def _optimize(self, statement: StatementDialect, parser: DirectiveParser) -> None:
        parsed = parser.minimize()
        self._optimization.optimize(parsed, self._program.levels, self._step, self._program.domains)
        self._program.levels += 1


def _with_mend(refusal: RefusalError, word: Token) -> RefusalError:
    """Words that lparse knew are names in gringo 3, which a syntax error after them should tell."""
    if refusal.mend or word.text not in _LPARSE_WORDS:
        return refusal
    return RefusalError(refusal.token, refusal.message, f"the directive is written '#{word.text}'")


def _head_signatures(rule: Rule) -> List[Signature]:
    head = rule.head
    if head is None:
        return []
    if isinstance(head, (Aggregate, Disjunction)):
        literals = [element.literal for element in head.elements]
    else:
        literals = [head]
    return [s for literal in literals if literal.is_atom and not literal.negated for s in signature_of(literal.left)]
