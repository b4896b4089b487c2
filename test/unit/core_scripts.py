"""Scripts for a driven core: events and expectations, one per line or separated by semicolons.

Events:
    goal KEY GOAL, cancel KEY     the core advances afterwards
    add KEY GOAL                  the core does not advance yet
    facts FACT...                 a message, after which the core advances
    hear ORIGIN FACT...           a message, after which the core does not advance yet
    wait SECONDS, pass SECONDS    time passes, and the core advances or not
    once                          one cycle begins
    pause, resume, stop           commands of an operator, after which the core advances
    leave NUMBER, slow NUMBER     end this search, counted from now on, for an arrival or for time
    succeed, fail VALUE, finish, until INTERFACE, run    methods of the driver, like any other word

Expectations, in which ``...`` stands for any text:
    is KEY STATE..., all KEY STATE...    the last states of a goal, or all
    says KEY TEXT                 the message of its end
    does ACTION..., done ACTION...    the awaited actions, or all that were sent, as INTERFACE,PARAMETER,CYCLE
    ends ACTION...                the cancelled actions
    sends TEXT, sent TEXT, unsent TEXT    the last update without its frame, one of all updates, none of them
    problem TEXT, problems NUMBER    one of the problems, their number
    queued KEY..., waits KEY TEXT    the goals that wait for a place in the program, and why one of them waits
    cycle NUMBER, patience NUMBER    the present cycle, the factor of a search's time
"""

import re

import pytest

from rosoclingo.oclingo import DroppedError, SolveOutcome, SolverError
from rosoclingo.reasoning.events import ActionsPreempted

FAULTS = {"refused": SolverError, "dropped": DroppedError, "undecided": SolveOutcome.INTERRUPTED}


def scripts(rows, slow=()):
    """Parametrize a test by rows, and by ``slow`` ones: the name of each, and its values, as ``row``."""
    further = [pytest.param(slow[name], id=name, marks=pytest.mark.slow) for name in slow]
    return pytest.mark.parametrize("row", [*(pytest.param(row, id=name) for name, row in rows.items()), *further])


def lines_of(script):
    """Yield the first word of each line of a script, the rest, and the line."""
    for line in filter(None, (one.strip() for one in re.split(r"[;\n]", script))):
        verb, _, rest = line.partition(" ")
        yield verb, rest.strip(), line


def perform(actor, script):
    """Play a script whose words are methods of the actor; return the actor."""
    for verb, rest, _ in lines_of(script):
        getattr(actor, verb)(*rest.split())
    return actor


def play(driver, script):
    """Play a script on a driver; return the driver."""
    for verb, rest, line in lines_of(script):
        if verb in EXPECTATIONS:
            EXPECTATIONS[verb](driver, rest, line)
        elif verb in EVENTS:
            EVENTS[verb](driver, *rest.split())
        else:
            perform(driver, line)
    return driver


def matches(text, pattern):
    """Return whether a text matches a pattern, in which ``...`` stands for any text."""
    return re.fullmatch(".*".join(map(re.escape, pattern.split("..."))), text, re.DOTALL) is not None


def bodies(driver):
    """Return the texts of all updates, each in one line without its frame."""
    return [" ".join(text.split()[2:-2]) for text in driver.journal.updates]


def wait(driver, seconds):
    let_pass(driver, seconds)
    driver.run()


def let_pass(driver, seconds):
    driver.now += float(seconds)
    driver.core.poll(driver.now)


def once(driver):
    assert driver.core.advance(driver.now)


def fault(driver, kind, *words):
    words, _, unless = " ".join(words).partition("unless ")
    driver.fail_for(FAULTS.get(kind), *words.split(), unless=unless or "#nothing")


def same(found, expected, line):
    assert found == expected, line


def states(driver, rest, line, every=False):
    key, *expected = rest.split()
    same(driver.states(key)[0 if every else -len(expected) :] if expected else driver.states(key), expected, line)


def says(driver, rest, line):
    key, _, pattern = rest.partition(" ")
    assert matches(driver.message(key), pattern), f"{line}\n{driver.message(key)}"


def waits(driver, rest, line):
    key, _, pattern = rest.partition(" ")
    some([one.waits for one in driver.feedback(key)], pattern, line)


def some(texts, pattern, line):
    assert any(matches(text, pattern) for text in texts), "\n".join((line, *texts))


def actions(found, expected, line):
    texts = plain(found)
    assert len(texts) == len(expected), f"{line}\n{texts}"
    assert all(map(matches, texts, expected)), f"{line}\n{texts}"


def plain(actions):
    """Return actions as texts without their predicate."""
    return [re.sub(r"^_\w+\(|\)$", "", action) for action in actions]


def preempted(driver):
    """Return the cancellations of actions, as facts."""
    return [str(action.cancellation) for event in driver.journal.of(ActionsPreempted) for action in event.actions]


def command(driver, name, *arguments):
    getattr(driver.core, name)(*arguments)
    driver.run()


EVENTS = {
    "pause": lambda driver: command(driver, "pause", True),
    "resume": lambda driver: command(driver, "pause", False),
    "stop": lambda driver: command(driver, "stop", "is aborted: stopped"),
    "add": lambda driver, *words: driver.core.add_goal(*words),
    "hear": lambda driver, origin, *facts: driver.core.receive(origin, facts),
    "wait": wait,
    "pass": let_pass,
    "once": once,
    "fault": fault,
    "leave": lambda driver, number: driver.end_search(number),
    "slow": lambda driver, number: driver.end_search(number, slow=True),
}

EXPECTATIONS = {
    "is": states,
    "all": lambda driver, rest, line: states(driver, rest, line, every=True),
    "says": says,
    "does": lambda driver, rest, line: actions(driver.awaited, rest.split(), line),
    "done": lambda driver, rest, line: actions(driver.journal.actions, rest.split(), line),
    "ends": lambda driver, rest, line: actions(preempted(driver), rest.split(), line),
    "sends": lambda driver, rest, line: some(bodies(driver)[-1:], rest, line),
    "sent": lambda driver, rest, line: some(bodies(driver), rest, line),
    "unsent": lambda driver, rest, line: same([one for one in bodies(driver) if matches(one, rest)], [], line),
    "problem": lambda driver, rest, line: some(driver.problems, rest, line),
    "problems": lambda driver, rest, line: same(len(driver.problems), int(rest), "\n".join((line, *driver.problems))),
    "queued": lambda driver, rest, line: same([one.key for one in driver.core.queue.waiting], rest.split(), line),
    "waits": waits,
    "cycle": lambda driver, rest, line: same(driver.core.cycle, int(rest), line),
    "patience": lambda driver, rest, line: same(driver.core.queue.patience, int(rest), line),
}
