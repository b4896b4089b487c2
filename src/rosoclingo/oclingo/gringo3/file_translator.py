"""Translation of a program's files from gringo 3's language, statement by statement."""

from pathlib import PurePath
from typing import Callable, Dict, List, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.gringo3.dialect import STEP_DIRECTIVES, Dialect, SourceFile
from rosoclingo.oclingo.gringo3.evidence import Evidence
from rosoclingo.oclingo.gringo3.grammar import UntranslatableError
from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind, TranslationError
from rosoclingo.oclingo.gringo3.optimization import OptimizationWriter
from rosoclingo.oclingo.gringo3.rewriter import rewritten
from rosoclingo.oclingo.gringo3.rules import RuleWriter
from rosoclingo.oclingo.gringo3.terms import (
    Element,
    ProgramScope,
    alternatives,
    has_interval,
    has_pool,
    show,
    variables,
)
from rosoclingo.oclingo.gringo3.visibility import ShowStatement, Visibility, signature

MARK = "% dialect: clingo 5"
"""The comment at the end of a translation."""


def translate_sources(
    sources: Sequence[SourceFile], undecided: Dialect
) -> List[Tuple[str, Tuple[Fault, ...], Dialect]]:
    """Return the translation, the remarks and the language of each file.

    An ambiguous file has the language of the other files if they agree, otherwise the ``undecided`` language. Raises
    TranslationError.
    """
    evidence = [Evidence(source) for source in sources]
    known = {one.dialect for one in evidence} - {None}
    common = known.pop() if len(known) == 1 else None
    dialects = [one.dialect or common for one in evidence]
    found = old = _translations(evidence, [one or Dialect.GRINGO3 for one in dialects])
    if None in dialects and undecided is not Dialect.GRINGO3:
        found = _translations(evidence, [one or undecided for one in dialects])
    if any(one.faults for one in found):
        raise TranslationError([fault for one in found for fault in one.faults])
    results = []
    for one, in_gringo3, dialect in zip(found, old, dialects):
        differs = dialect is None and in_gringo3.own_text != one.source.text
        remarks = [*one.remarks, *([_undecided(in_gringo3, undecided)] if differs else [])]
        results.append((one.text, tuple(remarks), dialect or (undecided if differs else Dialect.EITHER)))
    return results


def _translations(evidence: Sequence[Evidence], dialects: Sequence[Dialect]) -> List["FileTranslator"]:
    """Translate all files; ``#show`` and ``#hide`` statements come last, since they affect the whole program."""
    variables = (one.text for found in evidence for one in found.source.tokens if one.kind is TokenKind.VARIABLE)
    scope = ProgramScope(variables)
    visibility = Visibility(scope)
    translators = [FileTranslator(scope, visibility, one, dialect) for one, dialect in zip(evidence, dialects)]
    for one in translators:
        one.run()
    for one in translators:
        one.translate_displays()
    return translators


def _undecided(translator: "FileTranslator", dialect: Dialect) -> Fault:
    """Return a warning about the first line that has another meaning in gringo 3."""
    old, new = translator.source.text, translator.own_text
    place = next((n for n, (one, other) in enumerate(zip(old, new)) if one != other), min(len(old), len(new)))
    line, column = old.count("\n", 0, place) + 1, place - old.rfind("\n", 0, place)
    reading, remedy = new.split("\n")[line - 1].strip(), f"add '% dialect: {dialect.value}' to confirm this"
    message = f"gringo 3 reads this line as '{reading}'; read as {dialect.value}"
    return Fault(translator.source.name, line, column, message, remedy, "translation")


class FileTranslator:
    """Translates one file of a program; call :meth:`run` in the order of the files, then :meth:`translate_displays`.

    Attributes:
        source: the file.
        own_text: the translation without ``#show`` and ``#hide`` statements.
        remarks: the warnings about the file.
        faults: the statements that cannot be translated, with reasons.

    """

    def __init__(self, scope: ProgramScope, visibility: Visibility, evidence: Evidence, dialect: Dialect) -> None:
        self._scope, self._visibility, self._evidence, self._dialect = scope, visibility, evidence, dialect
        self.source = evidence.source
        self._name, self._file = self.source.name, PurePath(self.source.name).name
        self._texts: Dict[int, str] = {}  # the translated statements, by their numbers
        self.remarks: List[Fault] = []
        self.faults: List[Fault] = []
        self.own_text = ""
        self._rules = RuleWriter(scope)
        self._optimization = OptimizationWriter(scope, self._file)
        self._step = ""
        self._displays: List[Tuple[int, ShowStatement]] = []  # with the numbers of the statements

    @property
    def text(self) -> str:
        """The translation; if it differs from the source, it ends with a comment that names its language."""
        text = rewritten(self.source, self._texts)
        if text == self.source.text:
            return text
        return text + ("" if text.endswith("\n") else "\n") + MARK + "\n"

    def run(self) -> None:
        """Translate all statements."""
        for number in range(len(self._evidence.trees)):
            tokens = self.source.statement(number)
            try:
                if self._is_gringo3(number):
                    self._statement(number, tokens)
                else:
                    self._keep(tokens)
            except UntranslatableError as error:
                self.faults.append(error.fault(self._name))
        self.own_text = rewritten(self.source, self._texts)

    def translate_displays(self) -> None:
        """Translate ``#show`` and ``#hide`` statements, after all files were translated."""
        for number, statement in self._displays:
            try:
                self._texts[number] = self._visibility.text(statement)
            except UntranslatableError as error:
                self.faults.append(error.fault(self._name))

    def _is_gringo3(self, number: int) -> bool:
        """Return whether a statement is gringo 3's; its own syntax takes precedence over the file's language."""
        if self._evidence.source.pragma is Dialect.CLINGO5:
            return False
        statement = self._evidence.dialect_of(number)
        return statement is Dialect.GRINGO3 or (statement is Dialect.EITHER and self._dialect is Dialect.GRINGO3)

    def _statement(self, number: int, tokens: Sequence[SourceToken]) -> None:
        tree = self._evidence.trees[number]
        if isinstance(tree, UntranslatableError):
            if tokens[0].text in STEP_DIRECTIVES:
                return  # the loader reports malformed directives
            raise tree
        if tree.kind == "display":
            statement = ShowStatement(tree, self._step, self._scope.domains_of(variables([tree])))
            self._displays.append((number, statement))
            self._visibility.add(statement)
        elif tree.kind in _WRITERS:
            self._texts[number] = _WRITERS[tree.kind](self, tree)
            self._visibility.note(self._texts[number], self._step)
        if tree.kind != "const":
            self._scope.note_terms(self._file, tree)
        self._scope.used.update(token.text for token in tokens if token.kind is TokenKind.VARIABLE)

    def _keep(self, tokens: Sequence[SourceToken]) -> None:
        """Keep a statement of clingo 5."""
        if tokens[0].text == "#program":
            self._step = tokens[3].text if len(tokens) > 5 and tokens[2].text == "(" else ""
        if self._scope.domains_of([one.text for one in tokens]):
            message = "a statement of clingo 5 cannot use a variable that #domain declares"
            raise UntranslatableError(tokens[0], message, "use another variable")
        self._visibility.note(self.source.text[tokens[0].start : tokens[-1].end], self._step)

    def _weak(self, weak: SyntaxNode) -> str:
        return self._optimization.weak(weak, *self._rules.weak(weak), self._step)

    def _part(self, part: SyntaxNode) -> str:
        """Begin a part; its parameter follows the directive, or is in brackets after the name for ``#program``."""
        names = [token for token in part.tokens if token.type == "IDENTIFIER"]
        self._step = str(names[-1]) if len(names) > (part.kind == "program") else ""
        return _shown(part)

    def _const(self, const: SyntaxNode) -> str:
        term, name = const.parts[0], str(const.tokens[1])
        if has_pool(term) or has_interval(term):
            message = "a #const with a pool or a range cannot be translated"
            raise UntranslatableError(const, message, f"write {show(term)} in place of {name}")
        if any(part.kind == "variable" for part in term.walk()):
            raise UntranslatableError(const, "the value of a constant cannot contain a variable")
        self._scope.define_constant(const, name)
        return _shown(const)

    def _domain(self, domain: SyntaxNode) -> str:
        literal = domain.parts[0]
        atom = literal.parts[0].parts[0] if literal.parts[0].kind == "signed" else literal.parts[0]
        terms = atom.parts[0].parts if atom.parts else []
        if not terms or any(term.kind != "variable" or term.text == "_" for term in terms):
            raise UntranslatableError(literal, "#domain takes an atom whose arguments are variables")
        names = [term.text for term in terms]
        early = [name for name in names if name in self._scope.used]
        if early:
            message = f"#domain does not apply to earlier statements that use {', '.join(early)}"
            self.remarks.append(Fault(self._name, domain.line, domain.column, message, kind="translation"))
        self._scope.domains.append((show(literal), names))
        return ""

    def _external(self, external: SyntaxNode) -> str:
        declared = external.parts[0]
        if declared.kind == "signature":
            name, arity = signature(declared)
            arguments = f"({','.join('_' * arity)})" if arity else ""
            self._visibility.note(f"#external {name}{arguments}.", self._step)
            return _shown(external)
        element = Element.of(declared)
        conditions = [show(found) for condition in element.conditions for found in alternatives(condition)]
        conditions += self._scope.domains_of(variables([declared]))
        return f"#external {show(element.literal)}{' : ' if conditions else ''}{', '.join(conditions)}."

    def _optimize(self, statement: SyntaxNode) -> str:
        self._scope.levels += 1
        return self._optimization.optimize(statement, self._scope.levels - 1, self._step)


_WRITERS: Dict[str, Callable[[FileTranslator, SyntaxNode], str]] = {
    "rule": lambda translator, rule: translator._rules.rule(rule),
    "weak": FileTranslator._weak,
    **dict.fromkeys(("base", "program", "part"), FileTranslator._part),
    **dict.fromkeys(("forget", "iinit"), lambda translator, directive: _shown(directive)),
    "const": FileTranslator._const,
    "domain": FileTranslator._domain,
    "external": FileTranslator._external,
    "optimize": FileTranslator._optimize,
    "compute": lambda translator, statement: translator._optimization.compute(statement),
}


def _shown(directive: SyntaxNode) -> str:
    return " ".join(map(show, directive.children))
