"""The live page's server: access, messages to viewers, and the page in a browser."""

import gc
import json
import threading

import pytest
from published_runs import GOAL
from served_page import WEB, serving
from tornado.httpclient import HTTPClientError
from waiting import PATIENCE, wait_until

from rosoclingo.nodes.pages import page_server
from rosoclingo.nodes.pages.page_server import MOST_BYTES, MOST_MESSAGES, MOST_VIEWERS
from rosoclingo.runs.report_page import LIVE_SCRIPTS
from rosoclingo.runs.run_view import RunView


@pytest.fixture
def served():
    with serving() as one:
        yield one


# ---- files ----------------------------------------------------------------------------------------------------------


def test_server_serves_the_page_with_its_scripts(served):
    code, headers, page = served.get()
    assert (code, headers["Content-Type"]) == (200, "text/html; charset=utf-8")
    assert all((WEB / name).read_text() in page for name in (*LIVE_SCRIPTS, "page.css"))
    assert "default-src 'none'; img-src data:; style-src 'sha256-" in headers["Content-Security-Policy"]
    assert f"connect-src 'self' ws://127.0.0.1:{served.port} " in headers["Content-Security-Policy"]
    assert (headers["X-Frame-Options"], headers["X-Content-Type-Options"]) == ("DENY", "nosniff")
    assert [served.get(path)[0] for path in ("/../package.xml", "/%2e%2e/package.xml", "/model.js")] == [404] * 3
    code, headers, report = served.get("/report.html")
    assert (code, headers["Content-Disposition"]) == (200, 'attachment; filename="run.html"')
    assert '<script type="application/json" id="run">' in report


# ---- access ---------------------------------------------------------------------------------------------------------


def test_server_for_this_machine_accepts_only_its_own_names(served):
    for host in ("evil.example:80", "127.0.0.1.evil.example", "-", "a b", "127.0.0.1@evil"):
        assert served.get(Host=host)[0] in (400, 403), host
    assert served.get(Host=f"localhost:{served.port}")[0] == 200


def test_server_refuses_the_page_of_another_site(served):
    for origin in (
        "http://evil.example",
        "null",
        f"http://127.0.0.1:{served.port}.evil.example",
        f"http://localhost:{served.port}",
    ):
        with pytest.raises(HTTPClientError) as error:
            served.connect(origin)
        assert error.value.code == 403, origin
    with pytest.raises(HTTPClientError):
        served.connect("")


@pytest.mark.parametrize(
    ("headers", "status", "body"),
    [
        *(({"Origin": one}, 403, b"") for one in ("http://[::1", "http://\u2100.x", "[")),
        ({"Sec-WebSocket-Key": ""}, 400, b"Missing/Invalid WebSocket headers"),
    ],
)
def test_server_refuses_a_malformed_handshake(served, headers, status, body):
    found, text = served.shake_hands(**headers)
    assert (found, b"<html" in text, len(text) > 4) == (status, False, True)
    assert text.startswith(body)


def test_server_with_a_token_admits_only_its_holders():
    with serving(token="open sesame") as served:
        assert served.get()[0] == 403
        assert served.get("/report.html")[0] == 403
        assert served.get("/?token=wrong")[0] == 403
        assert served.get("/?token=%ff")[::2] == (400, "400 The token is not UTF-8\n")
        assert "Token needed" in served.get("/?token=wr%C3%B6ng")[2]
        with pytest.raises(HTTPClientError) as error:
            served.connect()
        assert error.value.code == 403
        code, headers, _ = served.get("/?token=open+sesame")
        cookie = headers["Set-Cookie"]
        assert (code, headers["Location"]) == (302, "/")
        assert "sesame" not in cookie
        assert "HttpOnly" in cookie
        assert "SameSite=Lax" in cookie
        mine = cookie.partition(";")[0]
        assert served.get(Cookie=mine)[0] == served.get("/report.html", Cookie=mine)[0] == 200
        assert served.get(Cookie=mine, Host="robot.example:8080")[0] == 200
        served.connect(Cookie=mine)


@pytest.mark.slow
def test_server_disconnects_viewers_that_send_too_much():
    with serving(take=lambda message: {}) as served:
        viewer = served.connect()
        assert viewer.receive()["whole"]
        viewer.send(json.dumps({"number": 1, "more": "x" * MOST_BYTES}))
        assert viewer.answer() is None
        wait_until(lambda: served.viewers() == 0, "the viewer to be gone")
        assert served.get()[0] == 200


@pytest.mark.slow
def test_server_limits_the_number_of_viewers(served):
    viewers = [served.connect() for _ in range(MOST_VIEWERS)]
    with pytest.raises(HTTPClientError) as error:
        served.connect()
    assert error.value.code == 503
    viewers.pop().close()
    wait_until(lambda: served.viewers() < MOST_VIEWERS, "a place")
    assert served.connect().receive()["whole"]


@pytest.mark.slow
def test_server_reports_its_end_and_leaves_nothing_open(served, capfd):
    viewers = [served.connect() for _ in range(3)]
    assert all(viewer.receive() for viewer in viewers)
    stopping = threading.Thread(target=served.server.stop, args=[PATIENCE])
    stopping.start()
    assert [viewer.end() for viewer in viewers] == [1001] * 3
    stopping.join()
    gc.collect()
    assert "destroyed" not in capfd.readouterr().err


# ---- messages -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_server_sends_whole_view_then_changes_then_another_view(served):
    viewer = served.connect()
    first = viewer.receive()
    assert (first["whole"], first["core"], first["goals"][0][1]["request"]) == (True, True, GOAL)
    served.do(lambda view: view.goal(140.0, "b", "g(b)"))
    more = viewer.receive()
    assert (more["whole"], more["about"], more["poses"]) == (False, None, [])
    assert [number for number, _ in more["goals"]] == [1]
    served.extra = {"core": False}
    assert viewer.receive()["core"] is False
    served.view = RunView(served.view.about)
    found = viewer.receive()
    assert found["whole"]
    assert (found["goals"], found["about"]["title"]) == ([], "A delivery")


# ---- questions ------------------------------------------------------------------------------------------------------


def test_server_answers_others_while_a_question_waits():
    event = threading.Event()

    def take(message):
        return (lambda: {"waited": event.wait(PATIENCE)}) if message["number"] == 1 else {"heard": True}

    with serving(take=take) as served:
        viewer = served.connect()
        for number in (1, 2):
            viewer.send(json.dumps({"number": number}))
        assert viewer.answer() == {"number": 2, "heard": True}
        event.set()
        assert viewer.answer() == {"number": 1, "waited": True}


NO_INTEGER = {"number": None, "fault": "'number' is not an integer"}


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ('{"number": 7, "order": 0}', {"number": 7, "heard": {"number": 7, "order": 0}}),
        *((f'{{"number": {one}}}', NO_INTEGER) for one in ('"7"', "1.5", "NaN", "[" * 100 + "]" * 100, "true")),
        *((one, None) for one in ("", "nonsense", "[1]", "3", "null", "[" * 4000)),
    ],
)
def test_server_answers_questions_and_disconnects_after_others(text, answer):
    with serving(take=lambda message: {"heard": message}) as served:
        viewer = served.connect()
        viewer.send(text)
        assert viewer.answer() == answer
        if answer is not None:
            viewer.send('{"number": 3}')
            assert viewer.answer() == {"number": 3, "heard": {"number": 3}}


# ---- in a browser ---------------------------------------------------------------------------------------------------


def test_server_disconnects_viewer_that_asks_too_often(monkeypatch):
    monkeypatch.setattr(page_server, "WINDOW", 3600.0)  # on any machine the messages come within it
    with serving(take=lambda message: {}) as served:
        viewer = served.connect()
        for _ in range(MOST_MESSAGES + 1):
            viewer.send("{}")
        assert len(list(iter(viewer.answer, None))) <= MOST_MESSAGES


@pytest.mark.slow
@pytest.mark.once
def test_page_is_no_wider_than_a_phone(page, served):
    served.do(lambda view: view.goal(140.0, "b", f"goal({'x' * 300},1)"))
    options = [["long" * 60, "long" * 60], ["2", "2"]]
    fields = [{"name": name, "options": options} for name in ("package", "from", "to")]
    served.extra = {"core": True, "orders": [{"title": "Deliver " * 20, "fields": fields}]}
    page.size(320, 740)
    try:
        page.open(served.address + "/")
        page.wait_for("document.querySelectorAll('#orders select').length === 3")
        page.wait_for("document.querySelectorAll('#goals tbody tr').length === 2")
        assert page.run("document.documentElement.scrollWidth") <= 320
    finally:
        page.size(1280, 900)


@pytest.mark.slow
@pytest.mark.once
def test_page_has_a_slider_only_while_one_looks_back(page, served):
    page.open(served.address + "/")
    page.wait_for("document.querySelectorAll('#goals tbody tr').length === 1")
    visible = "['slider', 'play', 'speed', 'before'].filter((one) => document.getElementById(one).offsetParent)"
    assert page.run(visible) == []
    assert page.text("#whole") == "Look back"
    page.click("#whole")
    assert page.run(visible) == ["slider", "play", "speed", "before"]
    assert page.run("live.player.home") is False
    page.press("Home", "#slider")
    served.do(lambda view: view.clock(160.0))
    page.wait_for("live.model.seconds === 60")
    assert page.text("#clock") == "0.0 s · cycle 1"
    page.press("End", "#slider")
    assert page.run(visible) == []
    served.do(lambda view: view.clock(170.0))
    page.wait_for("document.getElementById('clock').textContent.startsWith('1 min 10 s')")
    page.press("ArrowLeft")
    page.click("#whole")
    assert page.text("#clock").startswith("1 min 10 s"), "back to the present"


@pytest.mark.slow
@pytest.mark.once
def test_page_says_that_a_plan_is_searched_for_and_the_pace(page, served):
    page.open(served.address + "/")
    served.do(lambda view: (view.goal(150.0, "b", "g(b)"), view.clock(163.0)))
    page.wait_for("document.getElementById('now').textContent === 'Searching for a plan for 13.0 s'")
    served.do(lambda view: view.plan(164.0, 6, 7, ["_action_lib(move_base,office1,6)"], (1.0, 9.0)))
    page.wait_for("!document.getElementById('now').textContent.includes('Searching')")
    for seconds, shown in ((6.1, False), (12, True)):
        measured = f"live.model.measure(0, 0), live.model.measure(6000, {seconds}), live.player.update()"
        page.run(f"live.model.paces = [], {measured}")
        assert ("2.0 × real time" in page.text("#facts"), "real time" in page.text("#facts")) == (shown, shown)


@pytest.mark.slow
@pytest.mark.once
def test_page_connects_again(page):
    with serving() as served:
        page.open(served.address + "/")
        page.wait_for("document.getElementById('connection').textContent === 'Live'")
        port = served.port
    page.wait_for("document.getElementById('connection').textContent.startsWith('No connection')")
    view = RunView({"title": "Another run"})
    view.goal(5.0, "z", "g(z)")
    with serving(view, port=port):
        page.wait_for("document.getElementById('connection').textContent === 'Live'")
        page.wait_for("document.querySelector('h1').textContent === 'Another run'")
        assert page.texts("#goals tbody th") == ["g(z)"]
