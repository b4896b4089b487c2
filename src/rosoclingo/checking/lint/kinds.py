"""The kinds of findings and their severity. Comments silence findings by kind; doc/check.md describes the kinds."""

from typing import Dict, NamedTuple

from rosoclingo.oclingo.errors import Fault

ERROR, WARNING = "error", "warning"


class LintFinding(NamedTuple):
    """A fault with its severity, ERROR or WARNING."""

    fault: Fault
    severity: str

    def __str__(self) -> str:
        return f"{self.fault} [{self.fault.kind}]"


_ERRORS = (
    "syntax", "unsafe", "unknown-part", "keyword-arity", "redefinition", "unknown-constant", "constant-value",
    "stream-syntax", "configuration", "message-type",
)  # fmt: skip
_WARNINGS = (
    "missing-part", "late-external", "undefined", "unused", "misspelt", "mark", "unfounded", "no-match",
    "contradiction", "tautology", "same-variables", "exchanged", "lower-case", "no-step", "at-the-end",
    "other-step", "past-volatile", "look-ahead", "first-step", "history", "no-request", "no-return", "no-action",
    "restless", "idle-words", "hidden", "status-word", "unreachable-status", "no-success", "negative-constant",
    "no-number", "undefined-operation", "clingo", "translation", "incmode", "not-interpreted", "stream-fact",
    "no-interface", "idle-interface", "idle-reason", "no-label", "idle-label", "label-value", "like-reason",
    "idle-drawing", "unheard-fact", "unheard-order", "silence",
)  # fmt: skip

KINDS: Dict[str, str] = {**dict.fromkeys(_ERRORS, ERROR), **dict.fromkeys(_WARNINGS, WARNING)}
"""The severity of each kind: ERROR if the program or its configuration cannot be used."""
