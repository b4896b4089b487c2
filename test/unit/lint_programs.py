"""The programs in which the lint must find nothing, and the findings in any other."""

import re
from functools import lru_cache
from pathlib import Path

import pytest
from shipped import DATA, ENCODINGS, GOLDEN, ROOT

from rosoclingo.checking.lint.linting import findings, lint_sources
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

FILES = {
    "mailbot": [ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp"],
    "house": [ENCODINGS / "house.lp", ENCODINGS / "home.lp"],
    "day": [ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp", ENCODINGS / "golog" / "mailbot_day.golog"],
    "elevator": [ENCODINGS / "golog" / "elevator.golog"],
    "paper": [ENCODINGS / "paper.lp"],
    "two_offices": [ENCODINGS / "mailbot.lp", DATA / "two_offices.lp"],
    "template": [ROOT / "templates" / "package" / "encodings" / "@NAME@.lp"],
    **{name: [DATA / f"{name}.lp"] for name in ("battery", "errands", "team", "two_arms")},
}


def block(page, file):
    """Return a file that a document shows after a paragraph with its name."""
    text = (ROOT / "doc" / page).read_text(encoding="utf-8")
    pattern = rf"`[\w/]*{re.escape(file)}`(?:(?!\n\n).)*\n\n```\w*\n(.*?)^```$"
    return re.search(pattern, text, re.MULTILINE | re.DOTALL).group(1)


def seeded(text, old, new):
    """Return the text with the fault ``new`` in place of the first ``old``, and the line and column of it, or of its
    @.
    """
    assert old in text, f"{old} is not in the text"
    before, _, after = text.partition(old)
    offset = len(before) + max(new.find("@"), 0)
    changed = before + new.replace("@", "", 1) + after
    return changed, (changed.count("\n", 0, offset) + 1, offset - changed.rfind("\n", 0, offset))


@lru_cache(maxsize=None)
def program(name):
    """Return the sources of a program with all includes, each named relative to its folder."""
    if name == "garden":
        return (Source("garden.lp", block("tutorial.md", "garden.lp")),)
    if name == "workshop":
        return (Source("workshop.lp", block("long_actions.md", "workshop.lp")),)
    if name == "lift":
        return (Source("lift.lp", block("oclingo_service.md", "lift.lp")),)
    if name in FILES:
        texts = ReactiveProgram.from_files(FILES[name]).texts
        return tuple(Source(short(one.name), one.text) for one in texts)
    return tuple(Source(f"{name}.lp", one["program"]) for one in GOLDEN if one["name"] == name)


def marked(seeds):
    """Return the rows of a table of tests, those of large programs marked as slow, except for the first ones."""
    large = [one for one in seeds if one[0] in ("mailbot", "house")][4:]
    return [pytest.param(*one, marks=pytest.mark.slow if one in large else []) for one in seeds]


def short(name):
    """Return a file's name relative to the folder of the encodings."""
    path = Path(name).resolve()
    return path.relative_to(ENCODINGS).as_posix() if ENCODINGS in path.parents else path.name


NAMES = (*FILES, "garden", "lift", "workshop", *(one["name"] for one in GOLDEN))


def lint(sources, constants=None):
    """Return the lint's findings in the sources, which contain all their includes."""
    read, faults = lint_sources(sources, constants, whole=True)
    return findings(faults, [(one.name, one.text) for one in sources], faults if read is None else read.faults)
