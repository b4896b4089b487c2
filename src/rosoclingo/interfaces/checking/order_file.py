"""What people may order from a page, against a program: what ``check`` looks at with ``--orders``, and tries."""

from itertools import islice
from typing import Iterator, List, Sequence

import clingo

from rosoclingo.checking.more import Kinds
from rosoclingo.checking.sample_requests import names_in_facts
from rosoclingo.common.reading import Reader
from rosoclingo.interfaces.checking.yaml_places import YamlFile
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.survey import written
from rosoclingo.oclingo.progression.terms import Signature, parse_term
from rosoclingo.reasoning.keywords import request
from rosoclingo.runs.orders import OrderForm, read_orders

_REQUEST = Signature("_request", 2)

#: Goals of an order that are looked at, and atoms of rules that a message lists.
_LOOKED_AT, _MANY = 50, 4


class OrderFile:
    """The file of orders of that ``name``; raises ProgramError where it cannot be read.

    Attributes:
        file: its text.
        faults: what of it cannot be used.

    """

    def __init__(self, name: str) -> None:
        self.file = YamlFile(name)
        self.faults: List[Fault] = list(self.file.faults)
        self._forms: Sequence[OrderForm] = ()
        if not self.faults:
            reader = Reader(self.file.data)
            self._forms = read_orders(reader)
            self.faults += [self.file.fault(text, "configuration") for text in reader.faults]
            self.faults += self.file.doubles

    def requests(self, program: ReactiveProgram, labels: Sequence[str]) -> Kinds:
        """Return goals that may be ordered, of each form; without ``labels`` of all names of the program."""
        names = names_in_facts(program)
        return [form.samples(labels or names, names) for form in self._forms if not self.faults]

    def unheard(self, program: ReactiveProgram, labels: Sequence[str]) -> Iterator[Fault]:
        """Yield the orders whose goals no rule looks for."""
        for index, goals in enumerate(self.requests(program, labels)):
            tried = list(islice(goals, _LOOKED_AT))
            if tried and not any(_is_seen(program, parse_term(one)) for one in tried):
                text = f"[{index}].goal: no rule of the program asks for {tried[0]} ({_asked_for(program)})"
                yield self.file.fault(text, "unheard-order")


def _is_seen(program: ReactiveProgram, goal: clingo.Symbol) -> bool:
    return program.may_see([request(goal, program.first_step + 1)], program.first_step, program.first_step + 1)


def _asked_for(program: ReactiveProgram) -> str:
    terms = dict.fromkeys(written(one.occurrence.term) for one in program.survey.using.get(_REQUEST, ()))
    return "rules look at {}".format(", ".join(list(terms)[:_MANY])) if terms else "no rule looks at _request/2"
