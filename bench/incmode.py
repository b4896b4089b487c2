"""Solves a reactive program with plain clingo: the loop of its example incmode adds steps until there is a plan.

The search uses nothing of rosoclingo. The text of the program is unchanged, except that constraints of the volatile
part get an external atom ``query(t)`` and so hold at the last step only. All requests are facts of the first step.
"""

import re
import time
from itertools import count
from typing import List, Optional, Sequence, Tuple

import clingo

_SIGNATURE = re.compile(r"#external\s+\w+/\d+\s*\.")
"""A declaration of a signature, which rosoclingo requires and clingo rejects."""

_VOLATILE = re.compile(r"^#program volatile\(t\)\.$.*?(?=^#program|\Z)", re.MULTILINE | re.DOTALL)
"""A volatile part, of which each constraint begins a line."""


def shortest_plan(
    texts: Sequence[str], goals: Sequence[str], seconds: float = float("inf")
) -> Optional[List[List[Tuple[str, str]]]]:
    """Return a plan with the fewest steps; None after ``seconds`` of processor time.

    ``goals`` are terms. A step of the plan is a list of interfaces and parameters.
    """
    end = time.process_time() + seconds
    control = clingo.Control(["--warn=none"])
    for text in texts:
        queried = _VOLATILE.sub(lambda part: re.sub(r"(?m)^:- ", ":- query(t), ", part[0]), _SIGNATURE.sub("", text))
        control.add("base", [], queried)
    control.add("volatile", ["t"], "#external query(t).")
    control.add("base", [], "".join(f"_request({goal},2).\n" for goal in goals))
    control.ground([("base", [])])
    for step in count(1):
        last = clingo.Number(step)
        control.ground([("cumulative", [last]), ("volatile", [last])])
        control.release_external(clingo.Function("query", [clingo.Number(step - 1)]))
        control.assign_external(clingo.Function("query", [last]), True)
        with control.solve(yield_=True, async_=True) as handle:
            while not handle.wait(0.01):
                if time.process_time() > end:
                    handle.cancel()
                    return None
            model = handle.model()
            if model is not None:
                actions = sorted(atom.arguments for atom in model.symbols(atoms=True) if atom.match("_action_lib", 3))
                steps = range(1, step + 1)
                return [[(str(a), str(p)) for a, p, when in actions if when.number == one] for one in steps]
        if time.process_time() > end:
            return None
    return None
