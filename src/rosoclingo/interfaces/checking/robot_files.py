"""A robot's files against a program: what ``check`` looks at with ``--labels``, ``--interfaces`` and ``--orders``."""

import argparse
import sys
from contextlib import suppress
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional

import clingo

from rosoclingo.checking.lint.actions import Actions, Labelled, Named
from rosoclingo.checking.more import Kinds, Texts
from rosoclingo.common.labels import LabelTable
from rosoclingo.common.reading import Reader
from rosoclingo.interfaces.answers import REASONS, SUCCEEDED
from rosoclingo.interfaces.checking.odd_values import (
    frame_values,
    idle_drawings,
    label_values,
    labels_like_reasons,
    reasons_of,
)
from rosoclingo.interfaces.checking.order_file import OrderFile
from rosoclingo.interfaces.checking.yaml_places import YamlFile
from rosoclingo.interfaces.config import InterfaceSpec, survey
from rosoclingo.interfaces.templates import ActionScope, FillError, evaluate, labelled, term_with
from rosoclingo.oclingo.errors import Fault, ProgressionError
from rosoclingo.oclingo.program.likeness import likely_external, likely_word
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.program.survey import label_facts
from rosoclingo.oclingo.progression.terms import parse_atom, parse_term, signature_of


class RobotFiles:
    """The files of labels, interfaces and orders that are named on the command line."""

    def __init__(self) -> None:
        self._labels: Optional[YamlFile] = None
        self._interfaces: Optional[YamlFile] = None
        self._orders: Optional[OrderFile] = None

    @staticmethod
    def add_arguments(parser: argparse.ArgumentParser) -> None:
        """Add what names them."""
        parser.add_argument("--labels", metavar="FILE", help="the YAML file of the named locations")
        parser.add_argument("--interfaces", metavar="FILE", help="the YAML file of the interfaces")
        words = "the YAML file of what people may order from a web page, which --plan and --verify try as well"
        parser.add_argument("--orders", metavar="FILE", help=words)

    def sources(self, options: argparse.Namespace) -> List[Source]:
        """Read the files; return what the core adds of them to the program. Raises ProgramError."""
        self._labels = YamlFile(options.labels) if options.labels else None
        self._interfaces = YamlFile(options.interfaces) if options.interfaces else None
        self._orders = OrderFile(options.orders) if options.orders else None
        if self._labels is None:
            return []
        return [label_facts(one.name for one in _label_names(self._labels))]

    def look(self, options: argparse.Namespace, program: Optional[ReactiveProgram]) -> Texts:
        """Return what may be wrong with them, beside a program where it could be read."""
        files = [one for one in (self._labels, self._interfaces) if one is not None]
        faults = [fault for one in files for fault in (*one.faults, *one.doubles)]
        labels = self._look_at_labels(faults)
        specs = self._look_at_interfaces(faults)
        faults += labels_like_reasons(
            labels, reasons_of(spec for spec in specs.values() if spec.name in _asking(specs))
        )
        if program is not None:
            actions = Actions(program)
            faults += self._interface_faults(actions, specs)
            faults += actions.like_reasons(lambda name: reasons_of(one for one in specs.values() if one.name == name))
            faults += idle_drawings(program.survey)
            if self._labels is not None and not self._labels.faults:
                asking = _asking(specs) if self._interfaces is not None else actions.likely_asking(labels)
                faults += actions.without_label(labels, asking)
            faults += self._unheard(program, specs)
        if self._orders is not None:
            files.append(self._orders.file)
            faults += self._orders.faults
            faults += [] if program is None else self._orders.unheard(program, self._label_terms())
        return Texts(faults, [(one.name, one.text) for one in files])

    def requests(self, program: ReactiveProgram) -> Kinds:
        """Return what people may order."""
        return () if self._orders is None else self._orders.requests(program, self._label_terms())

    def _label_terms(self) -> List[str]:
        return [] if self._labels is None else [one.name for one in _label_names(self._labels)]

    def reasons(self) -> Dict[str, List[clingo.Symbol]]:
        """Return the values, other than success, with which the interfaces say that actions may return."""
        file = self._interfaces
        specs = {} if file is None or file.faults else survey(Reader(file.data))
        told = {spec.name: [rule.returns for rule in spec.rules if rule.status != SUCCEEDED] for spec in specs.values()}
        return {name: list(_terms([*results, *REASONS])) for name, results in told.items()}

    def _look_at_labels(self, faults: List[Fault]) -> List[Named]:
        file = self._labels
        if file is None or file.faults:
            return []
        reader = Reader(file.data)
        LabelTable.read(reader)
        faults += [file.fault(text, "configuration") for text in reader.faults]
        faults += label_values(file)
        return list(_label_names(file))

    def _look_at_interfaces(self, faults: List[Fault]) -> Mapping[str, InterfaceSpec]:
        file = self._interfaces
        if file is None or file.faults:
            return {}
        reader = Reader(file.data)
        specs = survey(reader)
        faults += [file.fault(text, "configuration") for text in reader.faults]
        faults += [file.fault(text, "message-type") for text in _type_faults(specs.values())]
        faults += [file.fault(text, "idle-reason") for text in _idle_reasons(specs, file.data)]
        faults += frame_values(file, specs)
        return specs

    def _interface_faults(self, actions: Actions, specs: Mapping[str, InterfaceSpec]) -> Iterator[Fault]:
        if self._interfaces is not None and not self._interfaces.faults:
            named = [self._interfaces.named(key)._replace(name=spec.name) for key, spec in specs.items()]
            yield from actions.without_interface(named)

    def _unheard(self, program: ReactiveProgram, specs: Mapping[str, InterfaceSpec]) -> Iterator[Fault]:
        """Yield the facts of interfaces that the program does not declare external."""
        for name, spec in specs.items():
            told = [(index, fact) for index, rule in enumerate(spec.rules) for fact in rule.facts]
            for index, fact in told if self._interfaces is not None else ():
                atom = _atom_of(fact)
                if atom is not None and signature_of(atom) not in program.external_signatures:
                    signature = signature_of(atom)
                    mend = likely_external(signature, program.external_signatures)
                    text = f"{name}.returns[{index}].facts: the program declares no external {signature} ({mend})"
                    yield self._interfaces.fault(text, "unheard-fact")  # type: ignore[union-attr]


def _idle_reasons(specs: Mapping[str, InterfaceSpec], entries: Mapping[str, Any]) -> Iterator[str]:
    """Yield the reasons to send a goal again with which an interface never returns."""
    for key, spec in specs.items():
        returned = {str(one).partition("(")[0] for one in (*REASONS, *(rule.returns for rule in spec.rules))}
        given = isinstance(entries[key], dict) and "retry_on" in entries[key]
        for reason in spec.retry_on if given and not any("$" in one for one in returned) else ():
            if reason not in returned:
                mend = likely_word(reason, returned) or f"it returns {', '.join(sorted(returned))}"
                yield f"{key}.retry_on: the interface never returns {reason} ({mend})"


def _terms(results: Iterable[Any]) -> Iterator[clingo.Symbol]:
    """Yield the results that are ground terms; what is filled in only later is left out."""
    for one in results:
        with suppress(ProgressionError):
            yield parse_term(str(one))


def _label_names(file: YamlFile) -> Iterator[Named]:
    """Yield the labels of a file by which the program knows them."""
    for name in file.data if isinstance(file.data, dict) else ():
        try:
            term = parse_term(str(name))
        except ProgressionError:
            continue  # the reader of labels tells
        yield file.named(str(name))._replace(name=str(term))


def _asking(specs: Mapping[str, InterfaceSpec]) -> Dict[str, Labelled]:
    """Return the actions whose goals ask for labels."""
    found: Dict[str, Labelled] = {}
    for spec in specs.values():
        paths = labelled(spec.goal)
        if paths:
            found[spec.name] = _labelled(paths)
    return found


def _labelled(paths: List[str]) -> Labelled:
    def asked(parameter: clingo.Symbol) -> Iterator[clingo.Symbol]:
        """Yield the terms that the paths lead to; parameters of another form have no label there."""
        for path in paths:
            try:
                term: Any = evaluate(path, ActionScope(parameter, 1))
            except FillError:
                continue
            if isinstance(term, clingo.Symbol):
                yield term

    return asked


def _atom_of(template: str) -> Optional[clingo.Symbol]:
    """Return the atom of a fact's template, something in place of what is filled in; None where it tells no atom."""
    with suppress(ProgressionError):
        return parse_atom(term_with(template, clingo.Function("x")))
    return None


def _type_faults(specs: Iterable[InterfaceSpec]) -> List[str]:
    """Return what of the entries does not fit the definitions of messages; nothing where there are none here."""
    told = list(specs)
    try:
        from rosoclingo.interfaces.type_faults import type_faults  # noqa: PLC0415 it needs genpy, which is ROS's
    except ModuleNotFoundError as error:
        if told:
            sys.stderr.write(f"check: types of messages are not looked at: there is no {error.name} here\n")
        return []
    return [text for spec in told for text in type_faults(spec)]
