"""Control programs for encodings/golog.lp: programs are terms, with rules for what is chosen or asked."""

import re
from pathlib import PurePath
from typing import Dict, FrozenSet, List, Sequence, Set, Tuple

from rosoclingo.languages.golog.clauses import (
    STEP,
    Literal,
    Names,
    Plain,
    Scope,
    Without,
    alternatives,
    first_token,
    unbound,
)
from rosoclingo.languages.golog.grammar import parse
from rosoclingo.languages.golog.recursion import endless_calls
from rosoclingo.languages.golog.scanner import GologError, Token
from rosoclingo.languages.golog.tree import (
    AnyAction,
    Around,
    Branch,
    Check,
    Choosing,
    Compound,
    Condition,
    ControlProgram,
    Loop,
    Procedure,
    Several,
    Statement,
    Step,
)
from rosoclingo.languages.golog.tree import (
    Sequence as Statements,
)
from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.program.languages import Translation

Signature = Tuple[str, int]
_NAME = re.compile(r"_*[a-z][A-Za-z0-9_]*\Z")
_VARIABLE = re.compile(r"_*[A-Z][A-Za-z0-9_]*")


def translate(text: str, name: str) -> Translation:
    """Return a control program as a reactive logic program; ``name`` is its file's.

    Raises ProgramError with all faults that are found.
    """
    faults: List[Fault] = []
    program = parse(text, name, faults)
    writer = _Writer(name, program, faults)
    if faults:
        raise ProgramError(sorted(faults, key=lambda one: (one.line, one.column)))
    return Translation("".join(f"{line}\n" for line in writer.lines), tuple(writer.places))


class _Writer:
    """Writes the rules of one file, one on a line; ``places`` says from where each comes (line, column)."""

    def __init__(self, file: str, program: ControlProgram, faults: List[Fault]) -> None:
        self._file, self._faults = file, faults
        stem = PurePath(file).stem
        self._stem = stem if _NAME.match(stem) else '"{}"'.format(re.sub(r'["\\\n]', "_", stem))
        self._count = 0
        self._actions: Set[str] = set()
        self._scope = Scope(file)
        self.lines: List[str] = []
        self.places: List[Tuple[int, int]] = []
        self._procedures: Dict[Signature, Procedure] = {}
        for one in program.includes:
            self._add(f"#include {one.text}.", one)
        self._add(f"#program cumulative({STEP}).", Token("end", "", 1, 1))
        for procedure in program.procedures:
            self._declare(procedure)
        faults += [self._fault(*found) for found in endless_calls(self._procedures)]
        for procedure in program.procedures:
            try:
                self._procedure(procedure)
            except GologError as error:
                faults.append(error.fault)

    def _fault(self, token: Token, message: str, mend: str) -> Fault:
        return Fault(self._file, token.line, token.column, message, mend)

    def _add(self, text: str, token: Token) -> None:
        self.lines.append(text)
        self.places.append((token.line, token.column))

    # ---- procedures ------------------------------------------------------------------------------------------------

    def _declare(self, procedure: Procedure) -> None:
        signature = (procedure.name.text, len(procedure.parameters))
        if signature in self._procedures:
            line = self._procedures[signature].name.line
            told = f"procedure {signature[0]} with {_arguments(signature[1])} is in line {line} already"
            self._faults.append(self._fault(procedure.name, told, "give one of them another name"))
            return
        self._procedures[signature] = procedure
        seen: Set[str] = set()
        for one in procedure.parameters:
            if one.token.text in seen:
                self._faults.append(self._fault(one.token, f"two parameters {one.token.text}", "rename one of them"))
            seen.add(one.token.text)

    def _procedure(self, procedure: Procedure) -> None:
        names = self._scope.inner({}, procedure.parameters)
        parameters = [names[one.token.text] for one in procedure.parameters]
        head = procedure.name.text + (f"({','.join(parameters)})" if parameters else "")
        body = self._statement(procedure.body, names)
        self._add(f"golog_body({head},{body},{STEP}) :- golog_call({head},{STEP}).", procedure.name)

    # ---- statements, each as a term --------------------------------------------------------------------------------

    def _statement(self, one: Statement, names: Names) -> str:
        if isinstance(one, Step):
            return self._step(one.what, names)
        if isinstance(one, AnyAction):
            return "any"
        if isinstance(one, Statements):
            return self._nested("seq", [self._statement(part, names) for part in one.statements]) or "nil"
        if isinstance(one, Check):
            return f"{one.token.text}({self._condition(one.token, one.condition, names)})"
        if isinstance(one, Branch):
            asked = self._condition(one.token, one.condition, names)
            return f"if({asked},{self._statement(one.yes, names)},{self._statement(one.no, names)})"
        if isinstance(one, Loop):
            return f"while({self._condition(one.token, one.condition, names)},{self._statement(one.body, names)})"
        if isinstance(one, Choosing):
            return f"{one.kind}({self._options(one, names)})"
        if isinstance(one, Several):
            parts = [self._statement(part, names) for part in one.parts]
            return (
                f"order({self._nested('l', [*parts, 'end'])})" if one.kind == "order" else self._nested(one.kind, parts)
            )
        return self._around(one, names)

    def _around(self, one: Around, names: Names) -> str:
        body = self._statement(one.body, names)
        if one.number is not None:
            return f"{one.kind}({one.number.text},{body})"
        return f"{one.kind}({body}" + ("" if one.other is None else f",{self._statement(one.other, names)}") + ")"

    @staticmethod
    def _nested(kind: str, parts: Sequence[str]) -> str:
        """Return ``kind(a,kind(b,c))`` for the parts a, b, c."""
        if not parts:
            return ""
        return "".join(f"{kind}({part}," for part in parts[:-1]) + parts[-1] + ")" * (len(parts) - 1)

    def _step(self, what: Compound, names: Names) -> str:
        term = self._scope.term(what, names)
        if (what.token.text, len(what.arguments)) in self._procedures:
            return f"call({term})"
        others = sorted(number for name, number in self._procedures if name == what.token.text)
        if others:
            told = f"procedure {what.token.text} has {' or '.join(map(_arguments, others))}, not {len(what.arguments)}"
            raise self._scope.fault(what.token, told, "call it with as many as it has")
        if term not in self._actions:  # so that check tells of an action that the domain does not know
            self._actions.add(term)
            self._add(
                f"golog_possible({term},{STEP}) :- golog_wants({term},{STEP}), golog_action({term},_,_,{STEP}).",
                what.token,
            )
        return f"do({term})"

    # ---- what is chosen, what is asked -----------------------------------------------------------------------------

    def _node(self, *texts: str) -> str:
        """Return a new name with the variables that stand in these texts."""
        self._count += 1
        found = dict.fromkeys(
            name for text in texts for name in _VARIABLE.findall(re.sub(r'"(?:[^"\\]|\\.)*"', "", text))
        )
        return f"in({','.join([self._stem, str(self._count), *found])})"

    def _condition(self, token: Token, condition: Condition, names: Names) -> str:
        """Return the name of a condition, and write what it means."""
        ways = alternatives(condition, names, self._scope)
        outer = set(names.values())
        used = [name for name in names.values() if any(name in _used(one) for way in ways for one in way)]
        name = self._node(*used)
        for way in ways:
            self._check_bound(token, way, outer, ())
            body = self._literals(way, f"golog_asked({name},{STEP})", outer)
            self._add(f"golog_true({name},{STEP}) :- {body}.", first_token(condition))
        return name

    def _options(self, one: Choosing, names: Names) -> str:
        """Return the name of a choice, and write what there is to choose from."""
        inner = self._scope.inner(names, one.variables)
        ways = alternatives(one.condition, inner, self._scope)
        body = self._statement(one.body, inner)
        outer = set(names.values())
        used = [name for name in names.values() if name in _VARIABLE.findall(body)]
        used += [name for name in names.values() if any(name in _used(part) for way in ways for part in way)]
        name = self._node(*dict.fromkeys(used))
        wanted = [inner[variable.token.text] for variable in one.variables]
        for way in ways:
            self._check_bound(one.token, way, outer, wanted)
            asked = self._literals(way, f"golog_picks({name},{STEP})", outer)
            self._add(f"golog_option({name},{body},{STEP}) :- {asked}.", one.token)
        return name

    def _check_bound(self, token: Token, way: Sequence[Literal], known: Set[str], wanted: Sequence[str]) -> None:
        for name in unbound(way, known, wanted):
            where = self._scope.first.get(name, token)
            told = f"no fluent says which values {where.text} may have"
            raise self._scope.fault(where, told, f"add a fluent that has it, or {where.text} in 1..3, or in {{a, b}}")

    def _literals(self, way: Sequence[Literal], asked: str, outer: Set[str]) -> str:
        """Return the body of a rule, and write what its negations mean."""
        plain = [one.text for one in way if isinstance(one, Plain)]
        return ", ".join([asked, *plain, *self._negations(way, asked, plain)])

    def _negations(self, way: Sequence[Literal], asked: str, plain: Sequence[str]) -> List[str]:
        found = []
        for one in way:
            if isinstance(one, Without):
                name = self._node(*sorted(one.variables))
                self._add(f"golog_asked({name},{STEP}) :- {', '.join([asked, *plain])}.", one.token)
                for inner in alternatives(one.condition, one.names, self._scope):
                    self._check_bound(one.token, inner, set(one.variables), ())
                    body = self._literals(inner, f"golog_asked({name},{STEP})", set(one.variables))
                    self._add(f"golog_true({name},{STEP}) :- {body}.", one.token)
                found.append(f"not golog_true({name},{STEP})")
        return found


def _used(literal: Literal) -> FrozenSet[str]:
    return literal.needs | literal.binds if isinstance(literal, Plain) else literal.variables


def _arguments(number: int) -> str:
    return f"{number} argument{'s' * (number != 1)}"
