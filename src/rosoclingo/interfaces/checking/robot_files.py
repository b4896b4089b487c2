"""Checks of a robot's files against a program: ``check`` with ``--labels``, ``--interfaces`` and ``--orders``."""

import argparse
import sys
from contextlib import suppress
from functools import partial
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional

import clingo

from rosoclingo.checking.extension import CheckedFiles, CheckExtension, Kinds
from rosoclingo.checking.lint.actions import Actions, LabelQuery, PlacedName
from rosoclingo.common.labels import LabelTable
from rosoclingo.interfaces.answers import REASONS, SUCCEEDED
from rosoclingo.interfaces.checking.order_file import Orders, order_requests, unheard_orders
from rosoclingo.interfaces.checking.suspicious_values import (
    frame_values,
    idle_drawings,
    label_values,
    labels_like_reasons,
    reasons_of,
)
from rosoclingo.interfaces.checking.yaml_places import YamlFile
from rosoclingo.interfaces.config import InterfaceSpec, survey
from rosoclingo.interfaces.templates import ActionScope, FillError, evaluate, label_references, term_with
from rosoclingo.oclingo.errors import Fault, ProgressionError
from rosoclingo.oclingo.program.likeness import likely_external, likely_word
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.program.survey import label_facts
from rosoclingo.oclingo.progression.terms import parse_atom, parse_term, signature_of
from rosoclingo.runs.orders import read_orders

Interfaces = YamlFile[Dict[str, InterfaceSpec]]


class RobotFiles(CheckExtension):
    """The files of labels, interfaces and orders given on the command line."""

    def __init__(self) -> None:
        self._driven: List[InterfaceSpec] = []

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Add the options for the files."""
        parser.add_argument("--labels", metavar="FILE", help="YAML file of the named locations")
        parser.add_argument("--interfaces", metavar="FILE", help="YAML file of the interfaces")
        words = "YAML file of the orders on a web page, which --plan and --verify try as well"
        parser.add_argument("--orders", metavar="FILE", help=words)

    def sources(self, options: argparse.Namespace) -> List[Source]:
        """Read the files; return the facts that the core adds to the program. Raises ProgramError."""
        self._labels = YamlFile(options.labels, LabelTable.read)
        self._interfaces: Interfaces = YamlFile(options.interfaces, survey)
        self._orders: Orders = YamlFile(options.orders, read_orders)
        return [label_facts(self._label_terms())] if self._labels.given else []

    def check(self, program: Optional[ReactiveProgram]) -> CheckedFiles:
        """Check the files, also against the program if it is readable."""
        files: List[YamlFile] = [one for one in (self._labels, self._interfaces, self._orders) if one.given]
        faults = [fault for one in files for fault in (*one.faults, *one.doubles)]
        labels, specs = list(_label_names(self._labels)), self._interfaces.value or {}
        actions = None if program is None else Actions(program)
        self._driven = _driven(specs, () if actions is None else actions.parameters)
        queries = _label_queries(self._driven)
        faults += label_values(self._labels)
        faults += labels_like_reasons(labels, reasons_of(spec for spec in self._driven if spec.name in queries))
        if specs:
            faults += _type_faults(self._interfaces, specs)
            faults += _idle_reasons(self._interfaces, specs)
            faults += frame_values(self._interfaces, specs)
        if program is not None and actions is not None:
            if self._interfaces.value is not None:
                names = [self._interfaces.named(spec.key, spec.name) for spec in self._driven]
                faults += actions.interface_faults(names)
                faults += _unheard(self._interfaces, specs, program)
            faults += actions.ambiguous_parameters(
                lambda name: reasons_of(one for one in self._driven if one.name == name)
            )
            faults += idle_drawings(program.survey)
            if self._labels.value is not None:
                known = queries if self._interfaces.given else actions.likely_queries(labels)
                faults += actions.label_faults(labels, known)
            if self._orders.given:
                faults += unheard_orders(self._orders, program, self._label_terms())
        return CheckedFiles(faults, [(one.name, one.text) for one in files])

    def requests(self, program: ReactiveProgram) -> Kinds:
        """Return the goals that people can order."""
        return order_requests(self._orders, program, self._label_terms())

    def reasons(self) -> Dict[str, List[clingo.Symbol]]:
        """Return the return values of failed actions by interface."""
        return {
            spec.name: list(_terms([*(rule.returns for rule in spec.rules if rule.status != SUCCEEDED), *REASONS]))
            for spec in self._driven
        }

    def _label_terms(self) -> List[str]:
        return [one.name for one in _label_names(self._labels)]


def _terms(results: Iterable[Any]) -> Iterator[clingo.Symbol]:
    """Yield the results that are ground terms; templates are skipped."""
    for one in results:
        with suppress(ProgressionError):
            yield parse_term(str(one))


def _label_names(file: YamlFile) -> Iterator[PlacedName]:
    """Yield the labels of a file as terms of the program; other names are reported elsewhere."""
    for name in file.data if isinstance(file.data, dict) else ():
        with suppress(ProgressionError):
            yield file.named(str(name), str(parse_term(str(name))))


# ---- interfaces -----------------------------------------------------------------------------------------------------


def _unheard(file: Interfaces, specs: Mapping[str, InterfaceSpec], program: ReactiveProgram) -> Iterator[Fault]:
    """Yield the facts of interfaces that the program does not declare external."""
    known = program.external_signatures
    for name, spec in specs.items():
        for index, fact in ((index, fact) for index, rule in enumerate(spec.rules) for fact in rule.facts):
            with suppress(ProgressionError):
                signature = signature_of(parse_atom(term_with(fact, clingo.Function("x"))))
                if signature not in known:
                    remedy = likely_external(signature, known)
                    text = f"{name}.returns[{index}].facts: the program declares no external {signature} ({remedy})"
                    yield file.fault(text, "unheard-fact")


def _idle_reasons(file: Interfaces, specs: Mapping[str, InterfaceSpec]) -> Iterator[Fault]:
    """Yield the entries of ``retry_on`` that an interface never returns."""
    for key, spec in specs.items():
        returned = {str(one).partition("(")[0] for one in (*REASONS, *(rule.returns for rule in spec.rules))}
        given = isinstance(file.data[key], dict) and "retry_on" in file.data[key]
        for reason in spec.retry_on if given and not any("$" in one for one in returned) else ():
            if reason not in returned:
                remedy = likely_word(reason, returned) or f"it returns {', '.join(sorted(returned))}"
                yield file.fault(f"{key}.retry_on: the interface never returns {reason} ({remedy})", "idle-reason")


def _type_faults(file: Interfaces, specs: Mapping[str, InterfaceSpec]) -> List[Fault]:
    """Return the contradictions to message definitions; without ROS, warn and return none."""
    try:
        from rosoclingo.interfaces.type_faults import type_faults  # noqa: PLC0415 it needs genpy, a part of ROS
    except ModuleNotFoundError as error:
        sys.stderr.write(f"check: message types are not checked: there is no module {error.name}\n")
        return []
    return [file.fault(text, "message-type") for spec in specs.values() for text in type_faults(spec)]


def _driven(specs: Mapping[str, InterfaceSpec], actions: Iterable[str]) -> List[InterfaceSpec]:
    """Return the interfaces; an entry whose name has variables stands for those of the program's ``actions``."""
    names = list(actions)
    return [one for spec in specs.values() for one in list(filter(None, map(spec.instance, names))) or [spec]]


def _label_queries(specs: Iterable[InterfaceSpec]) -> Dict[str, LabelQuery]:
    """Return the actions whose goals need labels."""
    paths = {spec.name: label_references(spec.goal) for spec in specs}
    return {name: partial(_labels_at, some) for name, some in paths.items() if some}


def _labels_at(paths: List[str], parameter: clingo.Symbol) -> Iterator[clingo.Symbol]:
    """Yield the terms at the paths; parameters of another form have none."""
    for path in paths:
        with suppress(FillError):
            term: Any = evaluate(path, ActionScope(parameter, 1))
            if isinstance(term, clingo.Symbol):
                yield term
