"""Values on a command line; argparse reports what is wrong with them."""

import argparse
from typing import Dict, Sequence

from rosoclingo.oclingo.errors import Fault, ProgramError

__all__ = ["TRIAL_SECONDS", "TRIAL_STEPS", "constants_of", "duration", "natural", "port", "positive", "seconds"]

TRIAL_STEPS = 30
"""Steps that a plan on trial may have."""

TRIAL_SECONDS = 60.0
"""Seconds of wall time for each request on trial, and again for the reasons where there is no plan."""


def positive(text: str) -> int:
    """Return a number from 1 on."""
    return _number(text, 1, 2**31 - 1)


def natural(text: str) -> int:
    """Return a number from 0 on."""
    return _number(text, 0, 2**31 - 1)


def port(text: str) -> int:
    """Return a TCP port, 0 for any."""
    return _number(text, 0, 65535)


def _number(text: str, lowest: int, highest: int) -> int:
    if text.isascii() and text.isdigit() and len(text) <= 10 and lowest <= int(text) <= highest:
        return int(text)
    raise argparse.ArgumentTypeError(f"{text!r} is no number from {lowest} to {highest}")


def duration(text: str) -> float:
    """Return seconds, which may be none."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < 1e9:
        raise argparse.ArgumentTypeError(f"{text!r} is no time in seconds")
    return value


def seconds(text: str) -> float:
    """Return seconds, more than none."""
    value = duration(text)
    if not value:
        raise argparse.ArgumentTypeError(f"{text!r} is no time in seconds")
    return value


def constants_of(words: Sequence[str]) -> Dict[str, str]:
    """Return the values of ``-c NAME=VALUE`` by their names; raise ProgramError for words that are none."""
    faults = [
        Fault(f"-c {word}", 0, 0, "no constant", "write NAME=VALUE") for word in words if not word.partition("=")[1]
    ]
    if faults:
        raise ProgramError(faults)
    return {word.partition("=")[0]: word.partition("=")[2] for word in words}
