"""Control programs as read: terms, conditions, statements and procedures, each with its place."""

from dataclasses import dataclass
from typing import Optional, Tuple, Union

from rosoclingo.languages.golog.scanner import Token


@dataclass(frozen=True)
class Variable:
    """A variable."""

    token: Token


@dataclass(frozen=True)
class Constant:
    """A number or a string."""

    token: Token


@dataclass(frozen=True)
class Compound:
    """A name with arguments, or without; an action, a fluent, or a value."""

    token: Token
    arguments: Tuple["Term", ...] = ()


@dataclass(frozen=True)
class Operation:
    r"""Two terms with + - * / or \ between them; for the negative of a term the first is None."""

    token: Token
    left: Optional["Term"]
    right: "Term"


Term = Union[Variable, Constant, Compound, Operation]


@dataclass(frozen=True)
class Truth:
    """true or false."""

    token: Token


@dataclass(frozen=True)
class Holds:
    """A fluent holds."""

    fluent: Compound


@dataclass(frozen=True)
class Comparison:
    """Two terms compared."""

    left: Term
    operator: str
    right: Term


@dataclass(frozen=True)
class Member:
    """A variable is a number from one to another, or one of some terms."""

    variable: Variable
    values: Tuple[Term, ...]
    interval: bool


@dataclass(frozen=True)
class Not:
    """A condition does not hold."""

    condition: "Condition"


@dataclass(frozen=True)
class Both:
    """Two conditions hold."""

    left: "Condition"
    right: "Condition"


@dataclass(frozen=True)
class Either:
    """One of two conditions holds, or both."""

    left: "Condition"
    right: "Condition"


@dataclass(frozen=True)
class Some:
    """There are values for variables with which a condition holds."""

    variables: Tuple[Variable, ...]
    condition: "Condition"


Condition = Union[Truth, Holds, Comparison, Member, Not, Both, Either, Some]


@dataclass(frozen=True)
class Step:
    """An action, or the call of a procedure."""

    what: Compound


@dataclass(frozen=True)
class AnyAction:
    """Some action."""

    token: Token


@dataclass(frozen=True)
class Check:
    """``test`` or ``await`` with a condition."""

    token: Token
    condition: Condition


@dataclass(frozen=True)
class Sequence:
    """Statements one after the other; none is nothing to do."""

    statements: Tuple["Statement", ...]


@dataclass(frozen=True)
class Branch:
    """if, with an empty sequence for a missing else."""

    token: Token
    condition: Condition
    yes: "Statement"
    no: "Statement"


@dataclass(frozen=True)
class Loop:
    """while."""

    token: Token
    condition: Condition
    body: "Statement"


@dataclass(frozen=True)
class Choosing:
    """``pick``, or ``every`` for a part of interrupts, with its variables, the condition on them and what is done."""

    kind: str
    token: Token
    variables: Tuple[Variable, ...]
    condition: Condition
    body: "Statement"


@dataclass(frozen=True)
class Several:
    """Two programs or more, as ``choice``, ``conc``, ``prio`` or ``order``."""

    kind: str
    parts: Tuple["Statement", ...]


@dataclass(frozen=True)
class Around:
    """``star`` or ``search`` of a program; ``retry`` with a number; ``try`` or ``undoing`` with another program."""

    kind: str
    body: "Statement"
    number: Optional[Token] = None
    other: Optional["Statement"] = None


Statement = Union[Step, AnyAction, Check, Sequence, Branch, Loop, Choosing, Several, Around]


@dataclass(frozen=True)
class Procedure:
    """A procedure with its parameters."""

    name: Token
    parameters: Tuple[Variable, ...]
    body: Statement


@dataclass(frozen=True)
class ControlProgram:
    """All that a file holds; ``includes`` are its tokens of file names, strings."""

    includes: Tuple[Token, ...]
    procedures: Tuple[Procedure, ...]
