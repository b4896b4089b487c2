"""Control programs for encodings/golog.lp: programs are terms, with rules for what is chosen or asked."""

import re
from pathlib import PurePath
from typing import FrozenSet, List, Mapping, NamedTuple, Sequence, Set, Tuple

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
from rosoclingo.languages.golog.recursion import Signature
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
from rosoclingo.oclingo.errors import Fault

_VARIABLE = re.compile(r"_*[A-Z][A-Za-z0-9_']*")
_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')
ROW = 8
"""So many statements or parts stand in one term; what follows is a term of its own, or terms would have no bound."""
DEEPEST = 300
"""So deep may a term be that a statement becomes."""
ORDERED = 20
"""So many parts may any order have."""


class Declared(NamedTuple):
    """A procedure, and the file that has it."""

    file: str
    procedure: Procedure


class Writer:
    """Writes the rules of one file, one on a line; ``places`` says from where each comes (line, column).

    ``procedures`` are those that its statements may call, its own among them. In the names that it gives to choices
    and conditions is ``stem``, a term that no other file of the program has. What is wrong is added to ``faults``.
    """

    def __init__(
        self,
        file: str,
        stem: str,
        program: ControlProgram,
        procedures: Mapping[Signature, Declared],
        faults: List[Fault],
    ) -> None:
        self._file, self._stem, self._procedures, self._faults = file, stem, procedures, faults
        self._count = 0
        self._name = Token("end", "", 1, 1)  # of the procedure that is written
        self._actions: Set[str] = set()
        self._scope = Scope(file)
        self.lines: List[str] = []
        self.places: List[Tuple[int, int]] = []
        for one in program.includes:
            self._add(f"#include {one.text}.", one)
        self._add(f"#program cumulative({STEP}).", Token("end", "", 1, 1))
        for procedure in program.procedures:
            try:
                self._procedure(procedure)
            except GologError as error:
                faults.append(error.fault)
            except RecursionError:
                faults.append(self._too_deep(procedure.name).fault)

    def _too_deep(self, token: Token) -> GologError:
        return self._scope.fault(token, "too much within each other", "make procedures of some")

    def _add(self, text: str, token: Token) -> None:
        depth = deepest = 0
        for sign in re.findall("[()]", _STRING.sub("", text)):
            depth += 1 if sign == "(" else -1
            deepest = max(deepest, depth)
        if deepest > DEEPEST:
            raise self._too_deep(token)
        self.lines.append(text)
        self.places.append((token.line, token.column))

    # ---- procedures ------------------------------------------------------------------------------------------------

    def _procedure(self, procedure: Procedure) -> None:
        self._name = procedure.name
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
            return self._row("seq", [self._statement(part, names) for part in one.statements]) or "nil"
        if isinstance(one, Check):
            return self._check(one, names)
        if isinstance(one, Branch):
            asked = self._condition(one.token, one.condition, names)
            return f"if({asked},{self._statement(one.yes, names)},{self._statement(one.no, names)})"
        if isinstance(one, Loop):
            return f"while({self._condition(one.token, one.condition, names)},{self._statement(one.body, names)})"
        if isinstance(one, Choosing):
            return f"{one.kind}({self._options(one, names)})"
        if isinstance(one, Several):
            return self._several(one, names)
        return self._around(one, names)

    def _check(self, one: Check, names: Names) -> str:
        asked = self._condition(one.token, one.condition, names)
        if one.token.text == "test":
            self._tell(asked, "the test in {} does not hold", one.token)
        return f"{one.token.text}({asked})"

    def _tell(self, name: str, text: str, token: Token) -> None:
        """Write what is said where a test or a choice leads no further."""
        place = re.sub(r'["\\\n]', "_", f"line {token.line} of {PurePath(self._file).name}")
        self._add(f'golog_told({name},"{text.format(place)}",{STEP}) :- golog_unmet({name},{STEP}).', token)

    def _several(self, one: Several, names: Names) -> str:
        parts = [self._statement(part, names) for part in one.parts]
        if one.kind != "order":
            return self._row(one.kind, parts)
        if len(parts) > ORDERED:
            told = f"{len(parts)} parts in any order, for which there are 2^{len(parts)} ways"
            raise self._scope.fault(self._name, told, f"have at most {ORDERED}")
        return f"order({self._nested('l', [*parts, 'end'])})"

    def _around(self, one: Around, names: Names) -> str:
        body = self._statement(one.body, names)
        if one.number is not None:
            return f"{one.kind}({one.number.text},{body})"
        return f"{one.kind}({body}" + ("" if one.other is None else f",{self._statement(one.other, names)}") + ")"

    def _row(self, kind: str, parts: Sequence[str]) -> str:
        """Return ``kind(a,kind(b,c))`` for the parts a, b, c; a long one goes on behind calls."""
        first = (len(parts) - 1) // ROW * ROW
        text = self._nested(kind, parts[first:])
        for begin in range(first - ROW, -1, -ROW):
            rest = self._node(text)
            self._add(f"golog_body({rest},{text},{STEP}) :- golog_call({rest},{STEP}).", self._name)
            text = self._nested(kind, [*parts[begin : begin + ROW], f"call({rest})"])
        return text

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
            files = {self._procedures[what.token.text, number].file for number in others} - {self._file}
            where = f" of {', '.join(sorted(files))}" if files else ""
            counts = " or ".join(map(arguments, others))
            told = f"procedure {what.token.text}{where} has {counts}, not {len(what.arguments)}"
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
        found = dict.fromkeys(name for text in texts for name in _VARIABLE.findall(_STRING.sub("", text)))
        return f"in({','.join([self._stem, str(self._count), *found])})"

    def _condition(self, token: Token, condition: Condition, names: Names) -> str:
        """Return the name of a condition, and write what it means."""
        self._scope.begin()
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
        self._scope.begin()
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
        if one.kind == "pick":
            self._tell(name, "there is nothing to pick in {}", one.token)
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


def arguments(number: int) -> str:
    """Return how many arguments something has, in words."""
    return f"{number} argument{'s' * (number != 1)}"
