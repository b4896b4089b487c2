"""The kinds of findings: their names, by which a comment silences them, how grave they are, and what they mean."""

from typing import Dict, NamedTuple

from rosoclingo.oclingo.errors import Fault

ERROR, WARNING = "error", "warning"


class Kind(NamedTuple):
    """A kind of findings: ``severity`` is error where the program, or what is set for it, cannot be used so."""

    severity: str
    meaning: str


class Finding(NamedTuple):
    """A fault with how grave it is, ERROR or WARNING."""

    fault: Fault
    severity: str

    def __str__(self) -> str:
        return f"{self.fault} [{self.fault.kind}]"


_ALL = {
    # what ends the reading of a program
    "syntax": (ERROR, "clingo, oClingo's directives or gringo 3's language know no such statement"),
    "unsafe": (ERROR, "a variable that no positive literal binds"),
    "unknown-part": (ERROR, "a program part other than base, cumulative(t) and volatile(t)"),
    "missing-part": (
        WARNING,
        "no cumulative or no volatile part; without the first no program for the core can be used",
    ),
    "keyword-arity": (ERROR, "a keyword with the wrong number of arguments"),
    "late-external": (
        WARNING,
        "an external is declared after the step that looks at it; an error in programs for the core",
    ),
    "redefinition": (ERROR, "the rules of two steps define the same atom, which clingo refuses"),
    # predicates and what they are about
    "undefined": (WARNING, "a predicate that no rule and no #external defines, so that it is never true"),
    "unused": (WARNING, "a predicate that nothing looks at and nothing shows, in a program with #show"),
    "misspelt": (
        WARNING,
        "a predicate that nothing looks at, or a constant or variable that stands once, with a name like another's",
    ),
    "mark": (WARNING, "a comma, dot, colon or semicolon that makes another statement of what is written"),
    "unfounded": (WARNING, "a predicate whose rules all need what follows from it alone, so that it is never true"),
    "no-match": (WARNING, "an atom with a value that nothing gives its predicate, or two with none in common"),
    "contradiction": (WARNING, "a body that holds an atom and its negation, or a comparison that never holds"),
    "tautology": (WARNING, "a rule that needs its own head, as where t stands for t-1: it gives nothing"),
    "same-variables": (WARNING, "X = Y for two variables that atoms bind: != may be meant, or one of them is enough"),
    "exchanged": (WARNING, "an argument that stands in the place of another"),
    "lower-case": (WARNING, "a name that is that of a variable of its rule but for its case, and stands nowhere else"),
    # steps
    "no-step": (WARNING, "a head in the part of steps without its step: the rules of two steps may define it in a run"),
    "at-the-end": (WARNING, "a head in the volatile part that the core reads: it holds at a plan's last step alone"),
    "other-step": (WARNING, "an action of another step than its rule or its return, an end of which no step is asked"),
    "past-volatile": (
        WARNING,
        "a look back at an atom of an earlier step that only the volatile part defines: it is gone",
    ),
    "look-ahead": (WARNING, "an atom of a later step, whose rules are not there yet"),
    "first-step": (WARNING, "a fact of a step whose own rules define its predicate"),
    "history": (WARNING, "a look back at all steps: no cycle is ever over, a long run grows without end"),
    # what the core and a program say to one another
    "no-request": (WARNING, "no #external _request/2: the program takes no goals"),
    "no-return": (WARNING, "no #external _return/3: the program never learns how its actions end"),
    "no-action": (WARNING, "no rule for _action_lib/3: the program plans no actions"),
    "restless": (WARNING, "each step has an action, even without a goal, and no _status/3 reports ends of goals"),
    "idle-words": (WARNING, "words for an action that the program does not have"),
    "hidden": (WARNING, "what the core reads out of answers is defined, but other predicates alone are shown"),
    "status-word": (WARNING, "a status that is none of accepted, rejected, succeeded, canceled, aborted"),
    "unreachable-status": (WARNING, "a status that no rule can ever give"),
    "no-success": (WARNING, "rules for _status/3, but none that says that a goal has succeeded"),
    # constants, clingo's infos
    "unknown-constant": (ERROR, "a value is given to a constant that the program does not have"),
    "constant-value": (ERROR, "a value that a constant of the program cannot have, as its own is a number"),
    "negative-constant": (WARNING, "a value below 0 where the program's own is above"),
    "no-number": (WARNING, "a name in a rule where a number has to be, though no #const gives it one"),
    "undefined-operation": (WARNING, "an operation without a value, like a+1: clingo leaves the rule's instance out"),
    "clingo": (WARNING, "what else clingo says while it grounds the first steps"),
    "translation": (WARNING, "what reads differently in gringo 3's language and in clingo 5's"),
    # other systems' programs
    "incmode": (WARNING, "an atom or constant that only clingo's incmode reads: query(t), imin, imax and istop"),
    "not-interpreted": (WARNING, "a theory atom, a script's function or a library, which only other drivers interpret"),
    # streams
    "stream-syntax": (ERROR, "a text that is no online progression"),
    "stream-fact": (WARNING, "a statement of a stream on a head that is no external, or that no rule can see"),
    # actions, interfaces, labels
    "no-interface": (WARNING, "an action of the program that no interface drives"),
    "idle-interface": (WARNING, "an interface that no action of the program drives"),
    "idle-reason": (WARNING, "a reason to send a goal again with which the interface never returns"),
    "no-label": (WARNING, "a place of the program that the labels do not have, where an action asks for its pose"),
    "idle-label": (WARNING, "a label that no action of the program ever names"),
    "label-value": (WARNING, "a frame with a leading slash, which tf2 refuses, or a yaw that looks like degrees"),
    "like-reason": (WARNING, "a label or parameter that equals a reason with which its action fails: done or failed?"),
    "idle-drawing": (WARNING, "a _draws fact that draws nothing"),
    "unheard-fact": (WARNING, "a fact of an interface that the program does not declare external"),
    "unheard-order": (WARNING, "an order of people whose goal no rule of the program asks for"),
    "configuration": (ERROR, "an entry of a YAML file that cannot be used"),
    "message-type": (ERROR, "a field or type of an interface that the message definitions do not have"),
    # comments
    "silence": (WARNING, "a comment 'check: ok' without the name of a kind"),
}

KINDS: Dict[str, Kind] = {name: Kind(*kind) for name, kind in _ALL.items()}
