"""Golog by its definitions in plain Python: Trans and Final, written independently of the encoding.

A program is a tuple of its kind and its parts, which can be programs. A state is a frozenset of fluents. Variables are
strings that begin with a capital letter; ``pick`` and ``every`` put values in their place.

    ("nil",)                      ("do", action)               ("test", condition)       ("await", condition)
    ("any",)                      ("seq", P, Q)                ("if", condition, P, Q)   ("while", condition, P)
    ("choice", P, Q)              ("pick", X, values, c, P)    ("every", X, values, c, P)
    ("star", P)                   ("conc", P, Q)               ("prio", P, Q)            ("order", (P, ...))
    ("call", name, arguments)     ("search", P)                ("searching", P)
    ("try", P, H)                 ("retry", n, P)              ("rerun", Q, n, P)
    ("undoing", P, U)             ("begun", P, U)

Conditions: a fluent; ("not", c), ("and", c, d), ("or", c, d), ("some", X, values, c), ("less", a, b). An action or a
fluent is a tuple of its name and its arguments.
"""

from functools import lru_cache

RAISE = ("raise",)
WRAPS = {"search", "searching", "try", "retry", "rerun", "undoing", "begun"}


def put(thing, variable, value):
    """Return ``thing`` with a value substituted for a variable."""
    if thing == variable:
        return value
    return tuple(put(one, variable, value) for one in thing) if isinstance(thing, tuple) else thing


def plain(thing):
    """Return ``thing`` with sums of numbers evaluated."""
    if isinstance(thing, tuple):
        thing = tuple(plain(one) for one in thing)
        if thing[:1] == ("minus",):
            return thing[1] - thing[2]
    return thing


class Interpreter:
    """Programs in a domain, with procedures.

    ``procedures`` maps names to pairs (parameters, body). ``domain`` has all ``actions``, ``possible(action, state)``
    and ``after(action, state)``. ``lost`` are actions that are impossible at present.
    """

    def __init__(self, domain, procedures=None):
        self.domain, self.procedures, self.lost = domain, procedures or {}, frozenset()
        self.transitions = lru_cache(maxsize=None)(self._transitions)
        self.final = lru_cache(maxsize=None)(self._final)
        self.rests = lru_cache(maxsize=None)(self._rests)

    def lose(self, lost):
        """Make these actions impossible from now on."""
        self.lost = frozenset(lost)
        for one in (self.transitions, self.final, self.rests):
            one.cache_clear()

    def holds(self, condition, state):
        """Return whether a condition holds."""
        kind = condition[0]
        if kind == "not":
            return not self.holds(condition[1], state)
        if kind == "and":
            return self.holds(condition[1], state) and self.holds(condition[2], state)
        if kind == "or":
            return self.holds(condition[1], state) or self.holds(condition[2], state)
        if kind == "some":
            return any(self.holds(put(condition[3], condition[1], value), state) for value in condition[2])
        if kind == "less":
            return plain(condition[1]) < plain(condition[2])
        return condition in state

    def body(self, name, arguments):
        """Return the body of a procedure for some arguments."""
        parameters, body = self.procedures[name]
        for variable, value in zip(parameters, plain(arguments)):
            body = put(body, variable, value)
        return body

    def options(self, program, state):
        """Return the programs among which pick and every choose."""
        _, variable, values, condition, body = program
        return [put(body, variable, value) for value in values if self.holds(put(condition, variable, value), state)]

    def possible(self, action, state):
        """Return whether an action is possible."""
        return action not in self.lost and self.domain.possible(action, state)

    # ---- Trans: pairs of an event and the remaining program; the event is None for a test, ("done", action) or
    # ---- ("bad", action) for one that fails, which leaves RAISE where nothing catches it

    def _transitions(self, program, state):
        return frozenset(getattr(self, "_" + program[0])(program, state))

    def _nil(self, program, state):
        return []

    def _do(self, program, state):
        action = plain(program[1])
        done = [(("done", action), ("nil",)), (("bad", action), RAISE)]
        return done if self.possible(action, state) else []

    def _any(self, program, state):
        return [one for action in self.domain.actions for one in self._do(("do", action), state)]

    def _test(self, program, state):
        return [(None, ("nil",))] if self.holds(program[1], state) else []

    _await = _test

    def _seq(self, program, state):
        _, first, second = program
        found = [
            (event, self._with(left, lambda left: ("seq", left, second))) for event, left in self._of(first, state)
        ]
        found += [(None, second)] if self.over(first, state) else []
        return found + (list(self._of(second, state)) if self.final(first, state) else [])

    def _if(self, program, state):
        _, condition, yes, no = program
        return self._of(yes if self.holds(condition, state) else no, state)

    def _while(self, program, state):
        _, condition, body = program
        return self._again(program, body, state) if self.holds(condition, state) else []

    def _star(self, program, state):
        return self._again(program, program[1], state)

    def _again(self, program, body, state):
        return [(event, self._with(left, lambda left: ("seq", left, program))) for event, left in self._of(body, state)]

    def _choice(self, program, state):
        return self._of(program[1], state) | self._of(program[2], state)

    def _pick(self, program, state):
        return [one for option in self.options(program, state) for one in self._of(option, state)]

    def _every(self, program, state):
        return [one for option in self.options(program, state) for one in self._again(program, option, state)]

    def _order(self, program, state):
        found = []
        for number, one in enumerate(program[1]):
            rest = ("order", program[1][:number] + program[1][number + 1 :])
            found += self._again(rest, one, state)
        return found

    def _conc(self, program, state):
        kind, first, second = program
        found, waits = [], kind == "prio" and self._of(first, state)
        if not self.locked(second):
            found += [(e, self._with(left, lambda left: (kind, left, second))) for e, left in self._of(first, state)]
        if not self.locked(first) and not waits:
            found += [(e, self._with(left, lambda left: (kind, first, left))) for e, left in self._of(second, state)]
        return found

    _prio = _conc

    def _call(self, program, state):
        return self._of(self.body(program[1], program[2]), state)

    def _search(self, program, state):
        return [
            (event, self._with(left, lambda left: ("searching", left))) for event, left in self._of(program[1], state)
        ]

    def _searching(self, program, state):
        return self._search(program, state) + ([(None, ("nil",))] if self.final(program[1], state) else [])

    def _try(self, program, state):
        _, body, handler = program
        return [(event, handler if left == RAISE else ("try", left, handler)) for event, left in self._of(body, state)]

    def _retry(self, program, state):
        return self._rerun(("rerun", program[2], program[1], program[2]), state)

    def _rerun(self, program, state):
        _, left, times, whole = program
        caught = ("retry", times - 1, whole) if times else RAISE
        found = self._of(left, state)
        return [(event, caught if rest == RAISE else ("rerun", rest, times, whole)) for event, rest in found]

    def _undoing(self, program, state):
        _, body, undo = program
        return [(e, self._with(left, lambda left: ("begun", left, undo))) for e, left in self._of(body, state)]

    _begun = _undoing

    def _of(self, program, state):
        return self.transitions(program, state)

    @staticmethod
    def _with(left, wrap):
        return RAISE if left == RAISE else wrap(left)

    def locked(self, program):
        """Return whether a program is within a search."""
        kind = program[0]
        if kind == "searching":
            return True
        if kind in ("conc", "prio"):
            return self.locked(program[1]) or self.locked(program[2])
        return kind in ("seq", "try", "rerun", "begun") and self.locked(program[1])

    # ---- Final -----------------------------------------------------------------------------------------------------

    def _final(self, program, state):
        kind, *parts = program
        if kind in ("nil", "star"):
            return True
        if kind in ("seq", "conc", "prio"):
            return all(self.final(one, state) for one in parts)
        if kind == "order":
            return all(self.final(one, state) for one in parts[0])
        if kind == "while" and not self.holds(parts[0], state):
            return True
        if kind == "every":
            return not self.options(program, state)
        return any(self.final(one, state) for one in self.within(program, state))

    def within(self, program, state):
        """Return the alternatives with which a program continues, or of which it is a context."""
        kind, *parts = program
        if kind == "if":
            return [parts[1] if self.holds(parts[0], state) else parts[2]]
        if kind == "while":
            return [parts[1]]
        if kind == "choice":
            return parts
        if kind in ("pick", "every"):
            return self.options(program, state)
        if kind == "call":
            return [self.body(*parts)]
        if kind in WRAPS:
            return [parts[1 if kind == "retry" else 0]]
        return []  # do, any, test, await

    # ---- waiting for external events
    # --------------------------------------------------------------------------------

    def _rests(self, program, state):
        kind, *parts = program
        if kind == "await":
            return not self.holds(parts[0], state)
        if kind == "seq":
            return self.rests(parts[0], state) or (self.final(parts[0], state) and self.rests(parts[1], state))
        if kind in ("conc", "prio"):
            resting = [self.rests(one, state) for one in parts]
            if any(rests and self.locked(one) for rests, one in zip(resting, parts)):
                return True
            return any(resting) and all(rests or self.final(one, state) for rests, one in zip(resting, parts))
        if kind == "while" and not self.holds(parts[0], state):
            return False
        if kind == "order":
            return any(self.rests(one, state) for one in parts[0])
        return any(self.rests(one, state) for one in (parts if kind == "star" else self.within(program, state)))

    def over(self, program, state):
        """Return whether a program has ended in every reading."""
        kind, *parts = program
        if kind == "while":
            return not self.holds(parts[0], state)
        if kind == "every":
            return not self.options(program, state)
        if kind in ("seq", "conc", "prio"):
            return all(self.over(one, state) for one in parts)
        if kind in ("if", "call") or kind in WRAPS:
            return all(self.over(one, state) for one in self.within(program, state))
        return program in (("nil",), ("order", ()))

    def passes(self, program, state):
        """Return whether the awaited event is there, or a part of the program over, in every reading."""
        kind, *parts = program
        if kind == "await":
            return self.holds(parts[0], state)
        if kind == "seq" and self.over(parts[0], state):
            return True
        if kind in ("seq", "searching", "try", "rerun", "begun"):
            return self.passes(parts[0], state)
        if kind in ("if", "call"):
            return any(self.passes(one, state) for one in self.within(program, state))
        if kind == "while":
            return self.holds(parts[0], state) and self.passes(parts[1], state)
        if kind == "retry":
            return self.passes(parts[1], state)
        if kind in ("conc", "prio"):
            first, second = parts
            if not self.locked(second) and self.passes(first, state):
                return True
            waits = kind == "prio" and self._of(first, state)
            return not waits and not self.locked(first) and self.passes(second, state)
        return False

    # ---- whole runs ------------------------------------------------------------------------------------------------

    def closure(self, programs, state):
        """Return all possible remainders after tests that pass in this state."""
        found, waiting = set(programs), list(programs)
        while waiting:
            for event, left in self.transitions(waiting.pop(), state):
                if event is None and left not in found:
                    found.add(left)
                    waiting.append(left)
        return found

    def traces(self, program, state, longest):
        """Return all sequences of at most ``longest`` actions that Do(program, state, ...) permits."""
        return set(self._traces({program}, state, longest))

    def _traces(self, programs, state, longest):
        reached = self.closure(programs, state)
        if any(self.final(one, state) for one in reached):
            yield ()
        if longest:
            following = {}
            for one in reached:
                for event, left in self.transitions(one, state):
                    if event is not None and event[0] == "done":
                        following.setdefault(event[1], set()).add(left)
            for action, left in following.items():
                for trace in self._traces(left, self.domain.after(action, state), longest - 1):
                    yield (action, *trace)
