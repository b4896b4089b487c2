"""Control programs for encodings/golog.lp: programs are terms, with rules for what is chosen or asked."""

import re
from pathlib import PurePath
from typing import Iterable, List, Mapping, NamedTuple, Sequence, Set, Tuple, Union

from rosoclingo.golog.conditions import (
    STEP,
    Bindings,
    GologError,
    Literal,
    Names,
    Plain,
    Without,
    alternatives,
    instances,
    unbound,
    variables_of,
)
from rosoclingo.golog.grammar import ControlProgram, choice, parameters, signature, statements
from rosoclingo.golog.recursion import Signature
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.grammars import SyntaxNode, Token

_VARIABLE = re.compile(r"_*[A-Z][A-Za-z0-9_']*")
_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')
ROW = 8
"""Limit of the statements or parts in one term; further ones are in terms of their own, so that terms stay small."""
DEEPEST = 300
"""Limit of the nesting of a term."""
ORDERED = 20
"""Limit of the parts of a statement in any order."""


_ROWS = {"interrupts": "prio", **{kind: kind for kind in ("seq", "choice", "conc", "prio", "order")}}
_ASKING = ("if", "while", "achieve", "test", "await", "until")


class Declared(NamedTuple):
    """A procedure, and the file that has it."""

    file: str
    procedure: SyntaxNode


class Writer:
    """Writes the rules of one file, one on a line.

    Its statements may call the ``procedures``, which include its own. The names of choices and conditions contain
    ``stem``, a term that no other file of the program has. Errors are added to ``faults``.

    Attributes:
        lines: the rules.
        places: line and column in the file from which each rule comes.

    """

    def __init__(
        self,
        file: str,
        stem: str,
        program: ControlProgram,
        procedures: Mapping[Signature, Declared],
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
        return self._scope.fault(place, "too much within each other", "make procedures of some")

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
        names = self._scope.inner({}, parameters(procedure), "parameters")
        written = [names[one.text] for one in parameters(procedure)]
        head = procedure.text + (f"({','.join(written)})" if written else "")
        body = self._statement(procedure.parts[-1], names)
        self._add(f"golog_body({head},{body},{STEP}) :- golog_call({head},{STEP}).", self._name)

    # ---- statements, each as a term --------------------------------------------------------------------------------

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

    def _tell(self, name: str, text: str, one: SyntaxNode) -> None:
        """Write the message for a test or a choice that leads no further."""
        place = re.sub(r'["\\\n]', "_", f"line {one.line} of {PurePath(self._file).name}")
        self._add(f'golog_told({name},"{text.format(place)}",{STEP}) :- golog_unmet({name},{STEP}).', one)

    def _row(self, kind: str, parts: Sequence[str]) -> str:
        """Return ``kind(a,kind(b,c))`` for the parts a, b, c; a long one goes on behind calls."""
        if kind == "order":
            if len(parts) > ORDERED:
                message = f"{len(parts)} parts in any order, for which there are 2^{len(parts)} ways"
                raise self._scope.fault(self._name, message, f"have at most {ORDERED}")
            return f"order({self._nested('l', [*parts, 'end'])})"
        first = max(0, len(parts) - 1) // ROW * ROW
        text = self._nested(kind, parts[first:])
        for begin in range(first - ROW, -1, -ROW):
            rest = self._node(text)
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
            raise self._scope.fault(what, message, "call it with as many as it has")
        if term not in self._actions:  # so that check reports an action that the domain does not know
            self._actions.add(term)
            asked = f"golog_wants({term},{STEP}), golog_action({term},_,_,{STEP})"
            self._add(f"golog_possible({term},{STEP}) :- {asked}.", what)
        return f"do({term})"

    # ---- what is chosen, what is asked -----------------------------------------------------------------------------

    def _node(self, *texts: str) -> str:
        """Return a new name with the variables that stand in these texts."""
        self._count += 1
        found = dict.fromkeys(name for text in texts for name in _VARIABLE.findall(_STRING.sub("", text)))
        return f"in({','.join([self._stem, str(self._count), *found])})"

    def _condition(self, one: SyntaxNode, names: Names) -> str:
        """Return the name of a statement's condition, and write what it means."""
        self._scope.begin()
        ways = alternatives(one.parts[0], names, self._scope, one.kind != "achieve")
        used = {variable for way in ways for literal in way for variable in variables_of(literal)}
        name = self._node(*(written for written in names.values() if written in used))
        for way in ways:
            self._check_bound(one, way, names.values(), ())
            body = self._literals(way, f"golog_asked({name},{STEP})")
            self._add(f"golog_true({name},{STEP}) :- {body}.", one.parts[0])
        if one.kind == "test":
            self._tell(name, "the test in {} does not hold", one)
        return name

    def _options(self, one: SyntaxNode, names: Names) -> str:
        """Return the name of a choice, and write what there is to choose from."""
        variables, condition, then = choice(one)
        inner = self._scope.inner(names, variables)
        self._scope.begin()
        ways = alternatives(condition, inner, self._scope)
        body = self._statement(then, inner)
        used = {variable for way in ways for literal in way for variable in variables_of(literal)}
        used.update(_VARIABLE.findall(body))
        name = self._node(*(written for written in names.values() if written in used))
        for way in ways:
            self._check_bound(one, way, names.values(), [inner[variable.text] for variable in variables])
            asked = self._literals(way, f"golog_picks({name},{STEP})")
            self._add(f"golog_option({name},{body},{STEP}) :- {asked}.", one)
        if one.kind == "pick":
            self._tell(name, "there is nothing to pick in {}", one)
        return name

    def _check_bound(
        self, one: SyntaxNode, way: Sequence[Literal], known: Iterable[str], wanted: Sequence[str]
    ) -> None:
        for name in unbound(way, known, wanted):
            where = self._scope.first.get(name, one)
            mend = f"add a fluent that has it, or {where.text} in 1..3, or in {{a, b}}"
            raise self._scope.fault(where, f"no fluent says which values {where.text} may have", mend)

    def _literals(self, way: Sequence[Literal], asked: str) -> str:
        """Return the body of a rule, and write what its negations mean."""
        body = ", ".join([asked, *(one.text for one in way if isinstance(one, Plain))])
        found = [body]
        for one in way:
            if isinstance(one, Without):
                name = self._node(*sorted(one.variables))
                self._add(f"golog_asked({name},{STEP}) :- {body}.", one.condition)
                for inner in instances(one.condition, one.names, self._scope):
                    self._check_bound(one.condition, inner, one.variables, ())
                    inside = self._literals(inner, f"golog_asked({name},{STEP})")
                    self._add(f"golog_true({name},{STEP}) :- {inside}.", one.condition)
                found.append(f"not golog_true({name},{STEP})")
        return ", ".join(found)


def arguments(number: int) -> str:
    """Return how many arguments something has, in words."""
    return f"{number} argument{'s' * (number != 1)}"
