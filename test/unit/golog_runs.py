"""Control programs as they run, in plain Python, by what doc/golog.md says: what may be left of each, step by step."""

from golog_interpreter import RAISE, Interpreter

TRIES = 3  # so often in a row an action fails before it is given up


class Runs:
    """Programs that were asked for, in the order in which they came; ``left`` is all that may be left of each.

    A step is ``begin``, which tells who ends, then ``act``. ``how`` tells what has become of a program.
    """

    def __init__(self, domain, procedures, state=frozenset()):
        self.interpreter = Interpreter(domain, procedures)
        self.domain, self.state = domain, state
        self.left, self.how, self.fails = {}, {}, {}

    def start(self, name, program):
        """A program begins."""
        self.left[name], self.how[name] = {program}, "accepted"
        self.fails = {}

    def happen(self, fluent, value):
        """Somebody else makes a fluent true, or false."""
        self.state = self.state | {fluent} if value else self.state - {fluent}

    def begin(self, cancelled=()):
        """A step begins: tests pass, programs end, or are cancelled."""
        self.interpreter.lose(action for action, times in self.fails.items() if times >= TRIES)
        for name in list(self.left):
            self._reach(name)
            if name in self.left and name in cancelled:
                undo = {undoing(one) for one in self.left.pop(name)}
                self.fails = {}
                self.left[name, "undone"] = undo
                self._reach((name, "undone"))

    def _reach(self, name):
        self.left[name] = self.interpreter.closure(self.left[name], self.state)
        if any(self.interpreter.final(one, self.state) for one in self.left[name]):
            del self.left[name]
            self.how[name[0] if name[1:] else name] = "canceled" if name[1:] else "succeeded"

    def offers(self, name):
        """What a program may do now."""
        events = {event for one in self.left[name] for event, _ in self.interpreter.transitions(one, self.state)}
        return {event[1] for event in events if event is not None and event[0] == "done"}

    def waits(self, name):
        """Whether a program may wait for what comes from outside."""
        return any(self.interpreter.rests(one, self.state) for one in self.left[name])

    def act(self, action, worked=True, free=False):
        """An action is done, or fails; or none is done. It is that of the first program that may do it."""
        takes = next((name for name in self.left if action in self.offers(name)), None) if action else None
        raised, after = False, {}
        for name, programs in self.left.items():
            mine = name == takes
            kept = set()
            if not mine or free:  # what is free may have been somebody else's
                kept = {one for one in programs if mine or not action or not self.interpreter.locked(one)}
            if mine:
                event = ("done" if worked else "bad", action)
                found = [
                    left for one in programs for e, left in self.interpreter.transitions(one, self.state) if e == event
                ]
                if RAISE in found:
                    raised, kept = True, kept | programs
                kept |= set(found) - {RAISE}
            after[name] = kept
        self.left = after
        if worked and action:
            self.state = self.domain.after(action, self.state)
        if worked:
            self.fails.pop(action, None)
        elif raised:
            self.fails[action] = self.fails.get(action, 0) + 1


def undoing(program):
    """What is to be done for what of a program has begun, once it is cancelled."""
    kind = program[0]
    if kind == "begun":
        return ("seq", undoing(program[1]), program[2])
    if kind in ("conc", "prio"):
        return ("conc", undoing(program[1]), undoing(program[2]))
    return undoing(program[1]) if kind in ("seq", "searching", "try", "rerun") else ("nil",)
