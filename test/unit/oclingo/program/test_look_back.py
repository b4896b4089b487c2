"""Terms in rules: their offsets from the step, and how far bodies look back."""

import clingo
import pytest
from clingo.ast import parse_string

from rosoclingo.oclingo.program.look_back import longest_look_back, shortest_look_back, time_offset

CONSTANTS = {"w": clingo.Number(3), "x": clingo.Function("y")}


def term(text):
    found = []
    parse_string(f"v({text}).", found.append)
    return found[-1].head.atom.symbol.arguments[0]


@pytest.mark.parametrize(
    ("text", "offset"),
    [
        ("t", 0),
        ("t+1", 1),
        ("w+t-1", 2),
        ("t-6/2", -3),
        ("2*t-t+w*2", 6),
        ("t*2-t", 0),
        ("(1-1)*T+t", 0),
        ("t*T-t*T+t", None),
        ("t\\10", None),
        ("t*7/6", None),
        ("2*t", None),
        ("-(w-t)", -3),
        ("-t", None),
        ("-|t|", None),
        ("~t", None),
        ("t^0", None),
        ("t..w", None),
        ("f(t)", None),
        ("x", None),
        ("t+x", None),
        ("|t|", None),
        ("w", None),
        ("T", None),
    ],
)
def test_time_offset_detects_step_plus_constant(text, offset):
    assert time_offset(term(text), "t", CONSTANTS) == offset


@pytest.mark.parametrize(
    ("body", "least", "greatest"),
    [
        ("t-T < 5", None, 4),
        ("t-T <= 5, T > t-4", None, 3),
        ("T > t-4, t-T <= 5", None, 3),
        ("2*t-2*T < 5, T >= t-w*2", None, 2),
        ("T <= t-3", 3, None),
        ("T < t-3, T <= t-2", 4, None),
        ("T <= t-2, T < t-3", 4, None),
        ("T < t+3", -2, None),
        ("t-9 < T < t-1", 2, 8),
        ("T = t-1", 1, 1),
        ("T != t", None, None),
        ("not t-T >= 5", None, None),
        ("not not t-T < 5", None, None),
        ("b(X) : t-T < 5, c(X)", None, None),
        ("1 { b(X) : t-T < 5 }", None, None),
        ("t-T-U < 5, b(U)", None, None),
        ("t+T < 5", None, None),
        ("t < 5", None, None),
        ("t-|T| < 5", None, None),
        ("t+|T| < 5", None, None),
        ("2*t-T < 5", None, None),
        ("5 < |T|", None, None),
        ("T < 5", None, None),
        ("T > 5", None, None),
        ("T < t", 1, None),
        ("T <= t", 0, None),
        ("T >= t", None, 0),
        ("-(T-t) < 5", None, 4),
    ],
)
def test_look_back_follows_from_comparisons_in_bodies(body, least, greatest):
    found = []
    parse_string(f":- a(T), {body}.", found.append)
    assert shortest_look_back(found[-1], "t", CONSTANTS).get("T") == least
    assert longest_look_back(found[-1], "t", CONSTANTS).get("T") == greatest
