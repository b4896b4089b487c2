"""The names in the shared delivery rules: few concern a domain, and few connect the files."""

import re

import pytest
from clingo.ast import ASTType
from shipped import ENCODINGS

from rosoclingo.oclingo.program.directives import Directives
from rosoclingo.oclingo.program.signatures import Signature, occurrences
from rosoclingo.oclingo.program.sources import Source, read_sources

FILES = sorted((ENCODINGS / "delivery").glob("*.lp"))


def statements(*files):
    parsed = [read_sources([Source.from_file(file)], Directives(), []) for file in files]
    return [one for sources in parsed for source in sources for one in source.statements]


def predicates(head, *files):
    """Return the predicates in heads, or those in bodies and conditions."""
    found = (one for statement in statements(*files) for one in occurrences(statement))
    return {one.signature for one in found if one.head == head}


def shown(*files):
    """Return the terms of `#show` statements."""
    terms = [one.term for one in statements(*files) if one.ast_type == ASTType.ShowTerm]
    return {Signature(one.name, len(one.arguments)) for one in terms}


def listed(file):
    """Return the predicates that a file lists in its first comment, at the start of a line or after another one."""
    text = file.read_text(encoding="utf-8").split("\n#")[0]
    lines = [line[4:].split("  ")[0] for line in text.splitlines() if line.startswith("%   ")]
    forms = [form for line in lines for form in re.findall(r"([_a-z]\w*)\(([^()]*)\)", line)]
    return {Signature(name, len(arguments.split(","))) for name, arguments in forms}


@pytest.mark.slow
def test_delivery_failure_rules_use_only_listed_hooks():
    rules = [ENCODINGS / "delivery" / name for name in ("requests.lp", "rules.lp", "statuses.lp")]
    others = [file for file in FILES if file not in rules]
    assert len(others) == 6
    hooks = predicates(False, *rules) & (predicates(True, *others) - predicates(True, *rules))
    assert hooks == listed(ENCODINGS / "delivery" / "rules.lp")
    assert len(hooks) <= 8


@pytest.mark.slow
def test_delivery_names_are_listed_or_begin_with_underscore():
    known = listed(ENCODINGS / "delivery.lp") | listed(ENCODINGS / "delivery" / "rules.lp")
    assert Signature("place", 1) in known
    names = {one for one in predicates(True, *FILES) | shown(*FILES) if not one.name.startswith("_")}
    assert names <= known
    given = {one.name for one in known - names if not one.name.startswith("_")}
    assert given == {"place", "connection", "distance", "start", "kind", "cancel", "order", "refused", "later"}
