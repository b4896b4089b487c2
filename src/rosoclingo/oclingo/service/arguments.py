"""Types of command-line arguments; argparse reports invalid values."""

import argparse
from typing import Callable, Dict, Sequence

from rosoclingo.oclingo.errors import Fault, ProgramError

TRIAL_STEPS = 30
"""Maximal number of steps of a trial plan."""

TRIAL_SECONDS = 60.0
"""Seconds of wall time for the plan of each trial request, and as much for explaining why there is none."""


def integer(lowest: int, highest: int = 2**31 - 1) -> Callable[[str], int]:
    """Return a type of arguments: the integers from ``lowest`` to ``highest``."""

    def parse(text: str) -> int:
        """Parse an integer."""
        if text.isascii() and text.isdigit() and len(text) <= 10 and lowest <= int(text) <= highest:
            return int(text)
        raise argparse.ArgumentTypeError(f"{text!r} is not an integer from {lowest} to {highest}")

    return parse


positive = integer(1)

natural = integer(0)

port = integer(0, 65535)
"""A TCP port; 0 stands for any free port."""


def duration(text: str) -> float:
    """Parse a time in seconds, at least 0."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < 1e9:
        raise argparse.ArgumentTypeError(f"{text!r} is not a time in seconds")
    return value


def seconds(text: str) -> float:
    """Parse a time in seconds greater than 0."""
    value = duration(text)
    if not value:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive time in seconds")
    return value


def constants_of(words: Sequence[str]) -> Dict[str, str]:
    """Return the values of ``-c NAME=VALUE`` by name; raise ProgramError for other words."""
    pairs = {word: word.partition("=") for word in words}
    faults = [Fault(f"-c {word}", 0, 0, "value missing", "write NAME=VALUE") for word in words if not pairs[word][1]]
    if faults:
        raise ProgramError(faults)
    return {name: value for name, _, value in pairs.values()}
