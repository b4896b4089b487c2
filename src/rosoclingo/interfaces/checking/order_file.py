"""Checks of the order forms of a web page against a program."""

from itertools import islice
from typing import Iterator, Sequence, Tuple

from rosoclingo.checking.extension import Kinds
from rosoclingo.checking.sample_requests import names_in_facts
from rosoclingo.interfaces.checking.yaml_places import YamlFile
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import parse_atom, parse_term
from rosoclingo.reasoning.keywords import request
from rosoclingo.reasoning.relevance import RelevanceAnalysis
from rosoclingo.runs.orders import OrderForm

#: Greatest number of goals of an order that are checked.
_CHECKED = 50

Orders = YamlFile[Sequence[OrderForm]]


def order_requests(file: Orders, program: ReactiveProgram, labels: Sequence[str]) -> Kinds:
    """Return the goals of each order, none for a fact.

    Without ``labels``, the names in the program's facts stand for labels.
    """
    return [() if form.is_fact else found for form, found in _samples(file, program, labels)]


def _samples(
    file: Orders, program: ReactiveProgram, labels: Sequence[str]
) -> Iterator[Tuple[OrderForm, Iterator[str]]]:
    names = names_in_facts(program)
    for form in file.value or () if not file.faults else ():
        yield form, form.samples(labels or names, names)


def unheard_orders(file: Orders, program: ReactiveProgram, labels: Sequence[str]) -> Iterator[Fault]:
    """Yield the orders whose goals no rule can see, and the facts for which the program declares no external."""
    relevance = RelevanceAnalysis.of(program)
    for index, (form, facts) in enumerate(_samples(file, program, labels)):
        atom = next((parse_atom(one) for one in facts if form.is_fact), None)
        if atom is not None and not program.declares_external(atom.name, len(atom.arguments)):
            text = f"[{index}].fact: the program declares no external {atom.name}/{len(atom.arguments)}"
            yield file.fault(text, "unheard-order")
    for index, goals in enumerate(order_requests(file, program, labels)):
        tried = list(islice(goals, _CHECKED))
        requests = [request(parse_term(one), program.first_step + 1) for one in tried]
        if requests and not any(map(relevance.is_relevant, requests)):
            advice = relevance.advice(requests[0])
            yield file.fault(f"[{index}].goal: no rule of the program can see {tried[0]} ({advice})", "unheard-order")
