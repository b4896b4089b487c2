"""Control programs during execution, by the rules of doc/golog.md: the possible remainders after each step."""

from golog_interpreter import RAISE, Interpreter

REJECTED = "rejected"
STUCK = 'canceled("not all that was begun could be undone")'
TRIES = 3  # failures in a row after which an action is aborted


class Runs:
    """Requested programs in order of arrival; ``left`` holds all possible remainders of each.

    A request NAME is ("run", NAME) there, its undo after a cancel ("undo", NAME). A step is ``begin``, which reports
    the ends, then ``act``. ``how`` gives the state of the last request of a name.
    """

    def __init__(self, domain, procedures):
        self.interpreter = Interpreter(domain, procedures)
        self.domain, self.state = domain, frozenset()
        self.left, self.how, self.fails, self.owed = {}, {}, {}, set()

    def happen(self, fluent, value):
        """Make a fluent true or false from outside."""
        self.state = self.state | {fluent} if value else self.state - {fluent}

    def begin(self, asked=None, cancelled=(), free=False):
        """Begin a step: tests pass, programs end.

        Before that, programs are requested (``asked``) by names of which none runs, None for an unknown one, and
        those of names in ``cancelled`` are cancelled; if both come at once, the cancel counts.
        """
        asked = asked or {}
        if asked or cancelled:
            self.fails = {}
        self.interpreter.lose(action for action, times in self.fails.items() if times >= TRIES)
        owed, self.owed = self.owed, {name for name in self.owed if ("undo", name) in self.left} - set(asked)
        self.how = {name: how for name, how in self.how.items() if name not in asked and how != REJECTED}
        kept = dict(self.left)
        for name in sorted(asked):
            self._ask(name, asked[name], name in cancelled)
        over = self._over(set(cancelled))
        for name in sorted(over):
            undo = {undoing(one) for one in over[name]}
            earlier = kept.get(("undo", name))
            if not undo:  # its remainder is unknown
                self.how[name] = "accepted" if earlier else STUCK
                self.owed |= {name} if earlier and name not in asked else set()
                continue
            self.left.pop(("undo", name), None)
            self.left["undo", name] = {("conc", one, new) for one in earlier for new in undo} if earlier else undo
            self.owed |= set() if name in asked else {name}
        self._end_undos({name for name in owed if name in cancelled and name not in asked}, free)

    def _ask(self, name, program, cancelled):
        if program is None:
            self.how[name] = REJECTED
        elif cancelled:
            self.how[name] = "canceled"
        else:
            self.left.pop(("run", name), None)
            self.left["run", name], self.how[name] = {program}, "accepted"

    def _over(self, cancelled):
        """Let tests pass and programs end; return the remainders of cancelled ones, by name."""
        found = {}
        for kind, name in [key for key in self.left if key[0] == "run"]:
            self._reach((kind, name))
            if self.is_done((kind, name)):
                del self.left[kind, name]
                self.how[name] = "succeeded"
            elif name in cancelled:
                found[name] = self.left.pop((kind, name))
        return found

    def _end_undos(self, cancelled, free):
        undone = [key for key in self.left if key[0] == "undo"]
        for key in undone:
            self._reach(key)
        for key in undone:
            if self.is_done(key) or key[1] in cancelled:
                self._end_undo(key, "canceled")
        waiting = any(self.waits(key) for key in self.left if key[0] == "undo")
        if not free and not waiting and not any(self.offers(key) for key in self.left):
            for key in [key for key in self.left if key[0] == "undo"]:
                self._end_undo(key, STUCK)

    def _end_undo(self, key, how):
        del self.left[key]
        if key[1] in self.owed:
            self.how[key[1]] = how
            self.owed.discard(key[1])

    def _reach(self, key):
        self.left[key] = self.interpreter.closure(self.left[key], self.state)

    def is_done(self, key):
        """Return whether a program can end."""
        return any(self.interpreter.final(one, self.state) for one in self.left[key])

    def offers(self, name):
        """Return the actions that a program offers now."""
        events = {event for one in self.left[name] for event, _ in self.interpreter.transitions(one, self.state)}
        return {event[1] for event in events if event is not None and event[0] == "done"}

    def waits(self, name):
        """Return whether a program can wait for an external event."""
        return any(self.interpreter.rests(one, self.state) for one in self.left[name])

    def act(self, action, worked=True, free=False):
        """Execute or fail an action, or none. It belongs to the first program that offers it."""
        takes = next((name for name in self.left if action in self.offers(name)), None) if action else None
        raised, after = False, {}
        for name, programs in self.left.items():
            mine = name == takes
            kept = set()
            if not mine or free:  # a free action can belong to others, except during a search
                kept = {one for one in programs if not action or not self.interpreter.locked(one)}
            passed = {one for one in programs if self.interpreter.passes(one, self.state)}
            passed = passed if passed != set(programs) else set()  # nothing follows it
            kept -= passed
            if mine:
                event = ("done" if worked else "bad", action)
                found = [
                    left for one in programs for e, left in self.interpreter.transitions(one, self.state) if e == event
                ]
                if RAISE in found:
                    raised, kept = True, kept | (programs - passed)
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
    """Return the remainder that undoes a cancelled program."""
    kind = program[0]
    if kind == "begun":
        return ("seq", undoing(program[1]), program[2])
    if kind in ("conc", "prio"):
        return ("conc", undoing(program[1]), undoing(program[2]))
    return undoing(program[1]) if kind in ("seq", "searching", "try", "rerun") else ("nil",)
