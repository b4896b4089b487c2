"""Commands of an operator: a paused core begins no actions and continues later, a stopped core ends all goals."""

from core_driver import ERRANDS, Driver, FaultyDriver
from core_scripts import play, scripts
from team_programs import TEAM

from rosoclingo.reasoning.events import GoalProgress, ModeChanged
from rosoclingo.reasoning.settings import CoreSettings

#: The name of each course, its program, and its script.
COURSES = {
    "the running action ends and no other begins": (
        ERRANDS,
        """goal a do(walk,1); add b do(run,2); pause; does walk,1,1; succeed; does; done walk,1,1; is b active
        resume; does run,2,...; succeed; does; is a succeeded; is b succeeded""",
    ),
    "a goal without a plan is aborted in a pause": (
        ERRANDS,
        "pause; goal a do(never,1); is a aborted; says a ...cannot be met...; goal b do(run,2); is b active; does",
    ),
    "a pause without an arrival changes no cycle": (
        ERRANDS,
        """goal a do(walk,1); pause; cycle 1; wait 9; cycle 1; resume; cycle 1; does walk,1,1; succeed; is a succeeded
        pause; wait 9; resume; cycle 2""",
    ),
    "stop ends all goals and the running action": (
        ERRANDS,
        """goal a do(walk,1); goal b do(run,2); stop; ends walk,1,1; says a do(walk,1) is aborted: stopped
        is a aborted; is b aborted; fail preempted; does; goal c do(run,3); does run,3,...; succeed; is c succeeded
        done walk,1,1 run,3,...""",
    ),
    "a goal waits until the program knows the end of another one with its identifier": (
        ERRANDS,
        """goal a do(walk,1); stop; goal b do(walk,1); facts _return(walk,preempted,1)
        sent :- not _action_lib(walk,1,1). _request(cancel(1),2). _return(walk,preempted,1).
        sent _request(do(walk,1),4).""",
    ),
    "actions of several cycles go on in a pause": (
        TEAM,
        """goal a job(saw,1); pause; goal b job(drill,2); does saw,1,1; is b active; facts _return(saw,1,1); does
        is a succeeded; resume; does drill,2,...; done saw,1,1 drill,2,...; problems 0""",
    ),
    "stop cancels actions of several cycles": (
        TEAM,
        """goal a job(saw,1); goal b job(drill,2); stop; ends saw,1,1 drill,2,2
        facts _return(saw,preempted,1); facts _return(drill,preempted,2); does; goal c job(saw,3); does saw,3,...""",
    ),
}


@scripts(COURSES)
def test_operator_commands_follow_the_course(row):
    text, script = row
    play(FaultyDriver(text, CoreSettings(horizon_limit=8, action_timeout=500.0)), script)


def test_stopped_mailbot_is_idle_until_the_next_goal():
    """The program still has a package to bring back, which waits for the next goal."""
    driver = Driver.of_shipped("mailbot.lp", "office.lp")
    driver.goal("a", "goal(office1,office3,1)").until("move_base")
    play(driver, "stop; is a aborted; fail preempted; does")
    assert driver.core.plan.actions
    driver.goal("b", "goal(office2,office1,2)").finish()
    play(driver, "is b succeeded; does")


def test_paused_core_reports_pause_to_clients():
    driver = play(Driver(), "goal a do(walk,1); pause; resume; stop")
    assert [one.mode.value for one in driver.journal.of(ModeChanged)] == ["paused", "running", "stopped"]
    assert [one.remark for one in driver.journal.of(GoalProgress)][-2:] == ["paused", ""]
