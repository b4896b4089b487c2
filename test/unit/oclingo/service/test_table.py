"""Answers as tables over time."""

import clingo
import pytest

from rosoclingo.oclingo.service.table import format_answer


def table(text, last=9, width=100):
    return format_answer(clingo.parse_term(f"({text},)" if text else "()").arguments, last, width)


@pytest.mark.parametrize(
    ("text", "last", "expected"),
    [
        (
            "move(a,b,1),move(b,c,2),at(a,0),at(a,1),at(b,2),-at(c,1),ready",
            9,
            "ready\n"
            "             0 1 2\n"
            "at(a,t)      x x .\n"
            "-at(c,t)     . x .\n"
            "at(b,t)      . . x\n"
            "move(a,b,t)  . x .\n"
            "move(b,c,t)  . . x\n",
        ),
        # predicates without times come first
        # terms that are not atoms
        # times of several digits
        ("p(9),p(11)", 20, "       9 10 11\np(t)   x  .  x\n"),
        ("", 5, ""),
    ],
)
def test_table_has_atom_rows_and_time_columns(text, last, expected):
    assert table(text, last) == expected


def test_wide_table_is_split_into_blocks():
    text = table(",".join(f"p({time})" for time in range(1, 31)) + ",q(29)", last=30, width=60)
    blocks = text.count("p(t)")
    assert blocks == 2
    assert text.count("q(t)") == 1, "empty rows of a block are omitted"
    assert max(map(len, text.splitlines())) <= 60
    assert text.count("x") == 31
