"""Solves a reactive program with plain clingo: the loop of its example incmode adds steps until there is a plan.

The search uses nothing of rosoclingo. The text of the program is unchanged, except that constraints of the volatile
part get an external atom ``query(t)`` and so hold at the last step only. All requests are facts of the first step.
"""

import re
import time
from itertools import count
from typing import Dict, List, Optional, Sequence, Tuple

import clingo
from clingo import ast

_SIGNATURE = re.compile(r"#external\s+\w+/\d+\s*\.")
"""A declaration of a signature, which rosoclingo requires and clingo rejects."""


def shortest_plan(
    texts: Sequence[str], goals: Sequence[str], seconds: float = float("inf")
) -> Optional[List[List[Tuple[str, str]]]]:
    """Return a plan with the fewest steps; None after ``seconds`` of processor time.

    ``goals`` are terms. A step of the plan is a list of interfaces and parameters.
    """
    end = time.process_time() + seconds
    control = clingo.Control(["--warn=none"])
    _load(control, [*texts, "#program base.\n" + "".join(f"_request({goal},2).\n" for goal in goals)])
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
                return _plan(model.symbols(atoms=True), step)
        if time.process_time() > end:
            return None
    return None


def _load(control: clingo.Control, texts: Sequence[str]) -> None:
    """Add programs to ``control``, with ``query(t)`` in the constraints of the volatile part."""
    queries: List[ast.AST] = []
    ast.parse_string(":- query(t).", lambda one: queries.extend(one.body if one.ast_type is ast.ASTType.Rule else ()))
    control.add("volatile", ["t"], "#external query(t).")
    with ast.ProgramBuilder(control) as builder:
        for text in texts:
            part = "base"

            def add(statement: ast.AST) -> None:
                nonlocal part
                if statement.ast_type is ast.ASTType.Program:
                    part = statement.name
                elif part == "volatile" and statement.ast_type is ast.ASTType.Rule and _is_constraint(statement):
                    statement = statement.update(body=[*statement.body, *queries])
                builder.add(statement)

            ast.parse_string(_SIGNATURE.sub("", text), add)


def _is_constraint(rule: ast.AST) -> bool:
    return str(rule.head) == "#false"


def _plan(atoms: Sequence[clingo.Symbol], last: int) -> List[List[Tuple[str, str]]]:
    steps: Dict[int, List[Tuple[str, str]]] = {step: [] for step in range(1, last + 1)}
    for atom in sorted(atoms):
        if atom.match("_action_lib", 3):
            interface, parameter, step = atom.arguments
            steps[step.number].append((str(interface), str(parameter)))
    return list(steps.values())
