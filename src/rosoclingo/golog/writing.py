"""Rules of control programs for encodings/golog.lp: programs as terms, choices and conditions as rules."""

import re
from pathlib import PurePath
from typing import Iterable, List, Sequence, Set, Tuple, Union

from rosoclingo.golog.conditions import (
    STEP,
    Bindings,
    GologError,
    Literal,
    Names,
    NegatedCondition,
    PlainLiteral,
    alternatives,
    instances,
    unbound,
)
from rosoclingo.golog.grammar import ControlProgram, Procedures, choice, parameters, signature, statements
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.grammars import SyntaxNode, Token

_VARIABLE = re.compile(r"_*[A-Z][A-Za-z0-9_']*")
_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')
ROW = 8
"""Maximum number of statements or parts in one term; longer sequences are split into several terms."""
DEEPEST = 300
"""Maximum nesting of a term."""
ORDERED = 20
"""Maximum number of parts of ``any order``."""


_ROWS = {"interrupts": "prio", **{kind: kind for kind in ("seq", "choice", "conc", "prio", "order")}}
_ASKING = ("if", "while", "achieve", "test", "await", "until")
_UNMET = {"test": "the test in {} does not hold", "pick": "there is nothing to pick in {}"}
"""Messages for a test that does not hold and a choice without options."""


class Writer:
    """Writes the rules of one file, one per line.

    Statements can call the ``procedures``, which include the file's own. The names of choices and conditions contain
    ``stem``, a unique term for the file. Errors are added to ``faults``.

    Attributes:
        lines: the rules.
        places: the original line and column of each rule.

    """

    def __init__(
        self,
        file: str,
        stem: str,
        program: ControlProgram,
        procedures: Procedures,
        faults: List[Fault],
    ) -> None:
        self._file, self._stem, self._procedures = file, stem, procedures
        self._count = 0
        self._actions: Set[str] = set()
        self._scope = Bindings(file)
        self.lines: List[str] = []
        self.places: List[Tuple[int, int]] = []
        for one in program.includes:
            self._add(f"#include {one.text}.", one.tokens[0])
        self._add(f"#program cumulative({STEP}).", Token("PROC", "proc", line=1, column=1))
        for procedure in program.procedures:
            self._name = procedure.tokens[0]
            try:
                self._procedure(procedure)
            except GologError as error:
                faults.append(error.fault)
            except RecursionError:
                faults.append(self._too_deep(self._name).fault)

    def _too_deep(self, place: Union[SyntaxNode, Token]) -> GologError:
        return self._scope.fault(place, "nesting is too deep", "move some of it into procedures")

    def _add(self, text: str, place: Union[SyntaxNode, Token]) -> None:
        depth = deepest = 0
        for sign in re.findall("[()]", _STRING.sub("", text)):
            depth += 1 if sign == "(" else -1
            deepest = max(deepest, depth)
        if deepest > DEEPEST:
            raise self._too_deep(place)
        self.lines.append(text)
        self.places.append((place.line or 1, place.column or 1))

    def _procedure(self, procedure: SyntaxNode) -> None:
        names = self._scope.inner_scope({}, parameters(procedure), "parameters")
        written = [names[one.text] for one in parameters(procedure)]
        head = procedure.text + (f"({','.join(written)})" if written else "")
        body = self._statement(procedure.parts[-1], names)
        self._add(f"golog_body({head},{body},{STEP}) :- golog_call({head},{STEP}).", self._name)

    # ---- statements as terms ---------------------------------------------------------------------------------------

    def _statement(self, one: SyntaxNode, names: Names) -> str:
        kind = {"until": "await", "achieve": "while"}.get(one.kind, one.kind)
        if kind == "step":
            return self._step(one.parts[0], names)
        if kind in ("pick", "every"):
            return f"{kind}({self._options(one, names)})"
        asked = [self._condition(one, names)] if one.kind in _ASKING else []
        inside = [self._statement(part, names) for part in statements(one)]
        if kind in _ROWS:
            return self._row(_ROWS[kind], inside)
        number = [one.text] if kind == "retry" else []
        rest = {"achieve": ["any"], "if": ["nil"] * (2 - len(inside))}.get(one.kind, [])
        words = [*number, *asked, *inside, *rest]
        return f"{kind}({','.join(words)})" if words else kind

    def _row(self, kind: str, parts: Sequence[str]) -> str:
        """Return ``kind(a,kind(b,c))`` for the parts a, b, c; calls link the terms of a long sequence."""
        if kind == "order":
            if len(parts) > ORDERED:
                message = f"{len(parts)} parts in any order have 2^{len(parts)} intermediate states"
                raise self._scope.fault(self._name, message, f"write at most {ORDERED}")
            return f"order({self._nested('l', [*parts, 'end'])})"
        first = max(0, len(parts) - 1) // ROW * ROW
        text = self._nested(kind, parts[first:])
        for begin in range(first - ROW, -1, -ROW):
            rest = self._new_name(text)
            self._add(f"golog_body({rest},{text},{STEP}) :- golog_call({rest},{STEP}).", self._name)
            text = self._nested(kind, [*parts[begin : begin + ROW], f"call({rest})"])
        return text

    @staticmethod
    def _nested(kind: str, parts: Sequence[str]) -> str:
        """Return ``kind(a,kind(b,c))`` for the parts a, b, c, and ``nil`` for none."""
        return "".join(f"{kind}({part}," for part in parts[:-1]) + (parts or ["nil"])[-1] + ")" * (len(parts) - 1)

    def _step(self, what: SyntaxNode, names: Names) -> str:
        term, (name, count) = self._scope.term(what, names), signature(what)
        if (name, count) in self._procedures:
            return f"call({term})"
        others = sorted(number for other, number in self._procedures if other == name)
        if others:
            files = {self._procedures[name, number].file for number in others} - {self._file}
            where = f" of {', '.join(sorted(files))}" if files else ""
            message = f"procedure {name}{where} has {' or '.join(map(arguments, others))}, not {count}"
            raise self._scope.fault(what, message, "correct the number of arguments")
        if term not in self._actions:  # lets the linter report actions that the domain does not define
            self._actions.add(term)
            asked = f"golog_wants({term},{STEP}), golog_action({term},_,_,{STEP})"
            self._add(f"golog_possible({term},{STEP}) :- {asked}.", what)
        return f"do({term})"

    # ---- choices and conditions ------------------------------------------------------------------------------------

    def _new_name(self, *texts: str) -> str:
        """Return a new name for a choice or condition, with the variables of these texts as arguments."""
        self._count += 1
        found = dict.fromkeys(name for text in texts for name in _VARIABLE.findall(_STRING.sub("", text)))
        return f"in({','.join([self._stem, str(self._count), *found])})"

    def _condition(self, one: SyntaxNode, names: Names) -> str:
        """Write the rules for a statement's condition and return its name."""
        self._scope.begin()
        ways = alternatives(one.parts[0], names, self._scope, one.kind != "achieve")
        return self._name_of(one, ways, names)

    def _options(self, one: SyntaxNode, names: Names) -> str:
        """Write the rules for the options of a choice and return its name."""
        variables, condition, then = choice(one)
        inner = self._scope.inner_scope(names, variables)
        self._scope.begin()
        ways = alternatives(condition, inner, self._scope)
        return self._name_of(one, ways, names, [inner[two.text] for two in variables], self._statement(then, inner))

    def _name_of(
        self,
        one: SyntaxNode,
        ways: Sequence[Sequence[Literal]],
        names: Names,
        bound: Sequence[str] = (),
        option: str = "",
    ) -> str:
        """Write a rule for each way in which a condition holds, or an ``option`` exists; return the name.

        The variables ``bound`` need values in each way.
        """
        used = {variable for way in ways for literal in way for variable in literal.variables}
        used.update(_VARIABLE.findall(option))
        name = self._new_name(*(written for written in names.values() if written in used))
        head = f"golog_option({name},{option},{STEP})" if option else f"golog_true({name},{STEP})"
        asked = f"golog_picks({name},{STEP})" if option else f"golog_asked({name},{STEP})"
        for way in ways:
            self._check_bound(one, way, names.values(), bound)
            self._add(f"{head} :- {self._rule_body(way, asked)}.", one if option else one.parts[0])
        if one.kind in _UNMET:
            place = re.sub(r'["\\\n]', "_", f"line {one.line} of {PurePath(self._file).name}")
            text = _UNMET[one.kind].format(place)
            self._add(f'golog_told({name},"{text}",{STEP}) :- golog_unmet({name},{STEP}).', one)
        return name

    def _check_bound(
        self, one: SyntaxNode, way: Sequence[Literal], known: Iterable[str], wanted: Sequence[str]
    ) -> None:
        for name in unbound(way, known, wanted):
            where = self._scope.first.get(name, one)
            remedy = f"add a fluent with it, or {where.text} in 1..3, or in {{a, b}}"
            raise self._scope.fault(where, f"no fluent determines the values of {where.text}", remedy)

    def _rule_body(self, way: Sequence[Literal], asked: str) -> str:
        """Return the body of a rule, and write the rules for its negated conditions."""
        body = ", ".join([asked, *(one.text for one in way if isinstance(one, PlainLiteral))])
        found = [body]
        for one in way:
            if isinstance(one, NegatedCondition):
                name = self._new_name(*sorted(one.variables))
                self._add(f"golog_asked({name},{STEP}) :- {body}.", one.condition)
                for inner in instances(one.condition, one.names, self._scope):
                    self._check_bound(one.condition, inner, one.variables, ())
                    inside = self._rule_body(inner, f"golog_asked({name},{STEP})")
                    self._add(f"golog_true({name},{STEP}) :- {inside}.", one.condition)
                found.append(f"not golog_true({name},{STEP})")
        return ", ".join(found)


def arguments(number: int) -> str:
    """Return a number of arguments in words."""
    return f"{number} argument{'s' * (number != 1)}"
