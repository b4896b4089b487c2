"""The shared delivery rules: their names, of which few concern a domain, and wrong starts."""

import re

import pytest
from clingo.ast import ASTType
from core_driver import Driver
from shipped import ENCODINGS

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.directives import Directives
from rosoclingo.oclingo.program.signatures import Signature, atoms_in, term_signature
from rosoclingo.oclingo.program.sources import Source, read_sources

FILES = sorted((ENCODINGS / "delivery").glob("*.lp"))


def statements():
    parsed = [read_sources([Source.from_file(file)], Directives(), []) for file in FILES]
    return [one for sources in parsed for source in sources for one in source.statements]


def defined():
    """Return the predicates in heads, and the terms of `#show` statements."""
    rules = statements()
    terms = [one.term for one in rules if one.ast_type == ASTType.ShowTerm]
    heads = {term_signature(term) for statement in rules for term, is_head, _ in atoms_in(statement) if is_head}
    return heads | {Signature(one.name, len(one.arguments)) for one in terms}


def listed(file):
    """Return the predicates that a file lists in its first comment, at the start of a line or after another one."""
    text = file.read_text(encoding="utf-8").split("\n#")[0]
    lines = [line[4:].split("  ")[0] for line in text.splitlines() if line.startswith("%   ")]
    forms = [form for line in lines for form in re.findall(r"([_a-z]\w*)\(([^()]*)\)", line)]
    return {Signature(name, len(arguments.split(","))) for name, arguments in forms}


@pytest.mark.slow
def test_delivery_names_are_listed_or_begin_with_underscore():
    known = listed(ENCODINGS / "delivery.lp") | listed(ENCODINGS / "delivery" / "rules.lp")
    assert Signature("place", 1) in known
    names = {one for one in defined() if not one.name.startswith("_")}
    assert names <= known
    given = {one.name for one in known - names if not one.name.startswith("_")}
    assert given == {"place", "connection", "distance", "start", "kind", "cancel", "order", "refused", "later"}


@pytest.mark.parametrize(
    ("encoding", "start", "valid"),
    [
        ("mailbot.lp", "start(a).", True),
        ("mailbot.lp", "start(moon).", False),
        ("mailbot.lp", "start(a). start(b).", False),
        ("fleet.lp", "start(r1,a). start(r2,a). start(unused,moon).", True),
        ("fleet.lp", "start(r1,a). start(r2,moon).", False),
        ("fleet.lp", "start(r1,a). start(r1,b).", False),
    ],
)
def test_delivery_robot_starts_at_one_place(encoding, start, valid):
    floor = Source("floor", f"#program base. office(a). office(b). corridor(a,b). {start}")
    constants = {"robots": "2"} if encoding == "fleet.lp" else {}
    program = ReactiveProgram([Source.from_file(ENCODINGS / encoding), floor], constants)
    problems = Driver(program=program).problems
    assert problems == [] if valid else "check --plan" in problems[0]
