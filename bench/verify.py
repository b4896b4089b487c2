#!/usr/bin/env python3
"""Measures the verification of the shipped programs: depth in events, number of states, processor time.

The programs are those of the paper, the office, the house, the tutorial and the package template. Each is verified to a
given depth, within a limit of processor time; the figure is the depth that was proven. Needs no ROS.

Run it in the built workspace: ./dev exec python3 bench/verify.py
"""

import re
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, Tuple

from figures import Figure, Option, main

from rosoclingo.checking.verifying.scope import EventSelection, VerifyLimits
from rosoclingo.checking.verifying.verification import verify
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

ROOT = Path(__file__).resolve().parents[1]


class Subject(NamedTuple):
    """A program to verify: its files, its depth (half of it in the short form), and goals and facts of each kind."""

    files: Tuple[str, ...]
    depth: int
    each: int = 2


SUBJECTS = {
    "paper": Subject(("encodings/paper.lp",), 4),
    "office": Subject(("encodings/mailbot.lp", "encodings/office.lp"), 2, 1),
    "house": Subject(("encodings/house.lp", "encodings/home.lp"), 2, 1),
    "tutorial": Subject(("doc/tutorial.md",), 4),
    "template": Subject(("templates/package/encodings/@NAME@.lp",), 4),
}


def load(files):
    """Return the program in ``files``; of a document, the first program in it."""
    sources = [Source.from_file(ROOT / name) for name in files]
    programs = (re.search(r"```prolog\n(.*?)```", one.text, re.DOTALL) for one in sources)
    return ReactiveProgram([replace(one, text=found[1]) if found else one for one, found in zip(sources, programs)])


def measure(options):
    """Verify the programs and print the verdicts; yield the figures."""
    for name in options.programs:
        subject = SUBJECTS[name]
        limits = VerifyLimits(events=subject.depth // (2 if options.quick else 1))
        verdict = verify(load(subject.files), EventSelection(most=subject.each), limits, options.seconds)
        print(f"{name}:\n{verdict.text()}", flush=True)
        if verdict.defects:
            raise SystemExit(f"{name}: the program has defects")
        yield Figure(f"{name}, depth", verdict.progress.proven, "events", "higher")
        yield Figure(f"{name}, states", verdict.progress.states, "", "higher")
        yield Figure(f"{name}, time", verdict.seconds, "s of processor")


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        programs=Option([*SUBJECTS], "programs to verify", choices=[*SUBJECTS]),
        seconds=Option(1200.0, "processor time for each", 60.0),
        quick=Option(False, "verify to half the depths", True),
    )
