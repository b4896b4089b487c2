"""The lint on random programs: it raises no error, and its findings have valid places."""

import re

import lint_programs
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosoclingo.checking.lint.kinds import KINDS
from rosoclingo.oclingo.program.sources import Source

PIECES = re.compile(r"[A-Za-z_][\w']*|#\w+|\d+|\s+|.", re.DOTALL)
WORDS = [
    "p", "q", "_request", "_action_lib", "_status", "t", "X", "_", "1", "0", "f", "not", "#external", "#show", "#const",
    "#program", "base", "cumulative", "volatile", "(", ")", "{", "}", ",", ";", ":-", ".", ":", "..", "=", "!=", "+",
    "-", "/", "#count", "#sum", "#forget", "#iinit", "#include", "#defined", "#heuristic", "#minimize",
    "@", "&", '"', "%",
    "%*", "\\", "#true", "|", "#script", "#end", "check: ok unused", "ä", "\x00",
]  # fmt: skip


def check(sources):
    """Check that each finding has a known kind and a line of the program, or none."""
    lines = {one.name: one.text.count("\n") + 2 for one in sources}
    for one in lint_programs.lint(sources):
        assert one.fault.kind in KINDS
        assert one.fault.message
        assert one.fault.line <= lines.get(one.fault.file, 1), one


@given(st.lists(st.sampled_from(WORDS), max_size=40).map(" ".join) | st.text(max_size=100))
def test_lint_handles_random_text(text):
    check([Source("random.lp", text)])


def mutated(text, changes):
    """Return the text with pieces dropped, doubled, swapped or replaced."""
    pieces = PIECES.findall(text)
    for kind, place, other in changes:
        here, there = place % len(pieces), other % len(pieces)
        if kind == "drop":
            pieces[here] = ""
        elif kind == "double":
            pieces[here] *= 2
        elif kind == "swap":
            pieces[here], pieces[there] = pieces[there], pieces[here]
        else:
            pieces[here] = WORDS[other % len(WORDS)]
    return "".join(pieces)


CHANGE = st.tuples(st.sampled_from(["drop", "double", "swap", "word"]), st.integers(0, 10**6), st.integers(0, 10**6))


@pytest.mark.mostly_slow
@pytest.mark.parametrize("name", ["battery", "bodies", "garden", "paper", "mailbot"])
@settings(max_examples=max(1, settings.default.max_examples // 8))
@given(st.data())
def test_lint_handles_mutations_of_programs(name, data):
    sources = list(lint_programs.program(name))
    place = data.draw(st.integers(0, len(sources) - 1))
    text = mutated(sources[place].text, data.draw(st.lists(CHANGE, min_size=1, max_size=4)))
    sources[place] = Source(sources[place].name, text)
    check(sources)
