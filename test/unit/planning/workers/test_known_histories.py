"""What a worker knows of histories is what its parent believes that it knows."""

import json

from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.oclingo.progression.updates import Over
from rosoclingo.planning.history import Checkpoint, History
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.workers import known_histories
from rosoclingo.planning.workers.known_histories import KnownHistories, Told


class Both:
    """A worker and its parent."""

    def __init__(self):
        self.told, self.known, self.sent = Told(), KnownHistories(), []

    def tell(self, log):
        message = json.loads(json.dumps(self.told.telling(log)))["history"]
        self.sent.append(message)
        return self.known.take(message)


def test_only_what_is_new_is_sent():
    both, log = Both(), History().then(Over(1), Over(2))
    assert both.tell(log).text() == log.text()
    assert both.tell(log.then(Over(3))).text() == log.then(Over(3)).text()
    assert [len(one["entries"]) for one in both.sent] == [2, 1]
    both.tell(log)
    both.tell(log.before)
    assert [len(one["entries"]) for one in both.sent[2:]] == [0, 1], "a shorter one was never told as a whole"


def test_what_a_command_leads_to_is_known():
    both, log = Both(), History().then(Over(1))
    mine = both.tell(log)
    number = both.told.next_number()
    both.known.keep(number, mine.then(Over(2)))
    later = log.then(Over(2))
    both.told.note(later, number)
    assert both.tell(later.then(Over(3))).before is not mine
    assert [len(one["entries"]) for one in both.sent] == [1, 1]


def test_whether_entries_were_predicted_is_told():
    both, log = Both(), History().then(Over(1), Over(2))
    log.foreseen = True
    found = both.tell(log)
    assert (found.foreseen, found.before.foreseen) == (True, False)


STEPS = st.lists(st.tuples(st.sampled_from(["longer", "back", "checkpoint"]), st.integers(0, 9)), max_size=60)


@given(STEPS)
def test_a_worker_has_the_history_that_is_meant(steps):
    both, logs = Both(), [History()]
    for number, (kind, place) in enumerate(steps):
        log = logs[-1 - place % len(logs)]
        if kind == "longer":
            log = log.then(Over(number))
        elif kind == "checkpoint":
            log = log.checkpoint(Snapshot(step=number + 1))
        logs.append(log)
        assert both.tell(log).text() == log.text()


def test_histories_that_were_used_long_ago_are_sent_again():
    both = Both()
    log = History().then(Checkpoint(Snapshot()), Over(1))
    both.tell(log)
    for number in range(known_histories.MOST):
        both.tell(History().then(Over(number)))
    assert both.tell(log).text() == log.text()
    assert len(both.sent[-1]["entries"]) == 2
