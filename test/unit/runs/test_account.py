import pytest
from published_runs import program_of

from rosoclingo.runs.account import Account
from rosoclingo.runs.events import GoalReport
from rosoclingo.runs.log_lines import PATIENCE


@pytest.fixture
def lines():
    return []


@pytest.fixture
def account(lines):
    return Account(lines.append)


def kinds(lines):
    return [line.split()[4] for line in lines]


def run(account):
    account.plan(10.0, 1, 9, [])
    account.goal(11.0, "a", "goal(office2,office1,1)")
    account.update(11.0, "#step 1.\n_request(goal(office2,office1,1),2).\n#end step.\n")
    account.plan(11.1, 1, 9, ["_action_lib(move_base,office2,1)", "_action_lib(pickup,1,2)"])
    account.dispatched(11.1, ["_action_lib(move_base,office2,1)"])
    account.status(11.2, "a", 1, "")
    account.returned(12.0, "move_base", ["_return(move_base,office2,1)"])
    account.update(
        12.0, "#step 2.\n:- not _action_lib(move_base,office2,1).\n_return(move_base,office2,1).\n#end step.\n"
    )
    account.plan(12.1, 2, 9, ["_action_lib(move_base,office2,1)", "_action_lib(pickup,1,2)"])


def test_account_has_a_line_for_each_event(account, lines):
    run(account)
    assert kinds(lines) == ["plan", "request", "update", "plan", "action", "goal", "return", "update", "plan"]
    assert lines[0].split()[:4] == ["0.0", "s", "cycle", "1"]
    assert lines[0].endswith("nothing to do")
    assert lines[3].endswith("move_base office2, pickup 1")
    assert lines[-1].split()[:4] == ["1.1", "s", "cycle", "2"], "since the request"
    assert lines[-1].endswith("plan     pickup 1")


def test_account_update_waits_for_events_that_it_reports(account, lines):
    account.update(1.0, "#step 2.\n_request(g(a,1),3).\n_return(go,x,1).\n#end step.\n")
    account.goal(1.0, "a", "g( a, 1 )")
    account.returned(1.0, "go", ["_return(go, x, 1)."])
    assert kinds(lines) == ["request", "return", "update"]
    account.goal(1.0, "b", "((")
    assert lines[-1].endswith("request  ((")


def test_account_holds_no_event_back_for_ever(account, lines):
    account.update(0.0, "#step 5.\n_return(go,x,4).\n#end step.\n")
    assert lines == []
    account.problem(PATIENCE, 1, "soon")
    account.problem(PATIENCE + 0.1, 1, "later")
    assert kinds(lines) == ["note", "update", "note"]
    assert [line.split()[0] for line in lines] == ["1.0", "1.0", "1.1"]
    account.update(3.0, "#step 6.\n_return(go,y,5).\n#end step.\n")
    account.clock(3.1 + PATIENCE)
    assert kinds(lines) == ["note", "update", "note", "update"]
    account.dispatched(6.0, ["_action_lib(go,x,9)"])
    account.finish()
    account.finish()
    assert kinds(lines)[4:] == ["action"], "once"


def test_account_shows_texts_that_are_no_atoms(account, lines):
    account.returned(0.0, "camera", ["_seen(ball)", "((("])
    account.update(0.0, "garbage")
    account.dispatched(0.0, ["((("])  # is not an action
    account.finish()
    assert [line.split(None, 5)[-1] for line in lines] == ["_seen(ball) from camera", "((( from camera", "garbage"]


def test_account_reports_status_changes_once_with_reason(account, lines):
    account.goal(0.0, "a", "g(1)")
    for _ in range(3):
        account.status(0.0, "a", 0, "")
        account.status(1.0, "a", 5, "g(1) is unknown")
    assert [line.split(None, 5)[-1] for line in lines[1:]] == ["g(1): rejected (is unknown)"]


def test_account_has_a_summary(account):
    run(account)
    account.status(12.1, "a", 3, "goal(office2,office1,1) is met")
    account.packages(12.1, [("3", "office2"), ("2", ""), ("5", "office3"), ("4", "office1"), ("1", "office2")])
    account.program(12.1, program_of("", {"office2": [1.0, 2.0]}).text())
    account.pose(12.1, 1.1, 2.1, 0.0)
    assert account.summary() == [
        "goal(office2,office1,1): done",
        "packages carried: 2",
        "packages office1: 4",
        "packages office2: 1, 3",
        "packages office3: 5",
        "robot: office2",
        "actions: move_base office2",
    ]
    assert account.seconds == pytest.approx(1.1)


def test_account_names_place_of_robot_by_a_label(account):
    account.pose(1.0, 1.1, 2.1, 0.0)
    labels = {"office2": [1.0, 2.0], "hall": {"x": 5.0, "y": 0.0}}
    account.program(1.1, program_of("", labels).text())
    account.beliefs(1.2, 1, ["at(hall,now)"])
    assert account.places.robot == "office2", "a measured position has priority"
    account.pose(1.3, 3.0, 3.0, 0.0)
    assert account.places.robot == "away from every label"


def test_account_lists_differences(account):
    run(account)
    account.packages(12.1, [("1", "office2")])
    assert account.differences({}) == []
    assert account.differences({"actions": ["_action_lib(move_base,office2,0)"]}, before=1) == []
    assert account.differences({"goals": ["active"], "robot": "", "packages": {"1": "office2"}}) == []
    found = account.differences({"goals": ["succeeded"], "packages": {"1": "office1"}, "actions": []})
    assert [difference.split(":")[0] for difference in found] == ["goals", "packages", "actions"]


def test_account_differences_skip_earlier_goal_that_ends_late():
    account = Account(lambda line: None)
    account.goals(0.0, [GoalReport("old", "g(1)", 1, "")])
    account.goal(1.0, "new", "g(2)")
    account.goals(2.0, [GoalReport("old", "g(1)", 5, ""), GoalReport("new", "g(2)", 3, "")])
    expect = {"goals": ["succeeded"]}
    assert account.differences(expect, sent=["new"]) == []
    assert account.differences(expect) != []


def test_account_counts_resent_action_again_only_in_another_run(account, lines):
    for run in ("first", "first", "second"):
        account.begin(run)
        account.dispatched(1.0, ["_action_lib(go,x,1)"])
    account.finish()
    assert account.dispatched_actions == ["_action_lib(go,x,1)"] * 2
    assert [line.split()[-2:] for line in lines if " action " in line] == [["go", "x"]] * 2


def test_account_reports_the_state_on_request(lines):
    account = Account(lines.append, with_state=True)
    account.plan(0.0, 1, 9, [])
    account.beliefs(0.0, 1, ["_status(1,accepted,now)", "at(a,now)", "lit(now)"])
    account.beliefs(1.0, 1, ["_action_lib(go,b,now)", "at(a,now)", "lit(now)"])
    account.beliefs(2.0, 1, ["at(b,now)", "lit(now)"])
    assert [line.split("state")[1].strip() for line in lines[1:]] == ["+at(a,now) +lit(now)", "+at(b,now) -at(a,now)"]
    silent = Account(lines.append)
    silent.beliefs(0.0, 1, ["at(a,now)"])
    silent.finish()
    assert len(lines) == 3
