"""A headless Chromium for tests of pages, controlled by its DevTools protocol over a pipe."""

import json
import os
import selectors
import shutil
import subprocess
import tempfile
import time
from contextlib import suppress

from waiting import PATIENCE, wait_until

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
OPTIONS = (
    "--headless",
    "--no-sandbox",  # which containers do not allow
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-extensions",
    "--no-first-run",
    "--remote-debugging-pipe",
)


def found():
    """Return the path of a browser that starts, None without one (Ubuntu's is a snap)."""
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        return None
    with suppress(OSError, subprocess.TimeoutExpired):
        if subprocess.run([path, "--version"], capture_output=True, timeout=PATIENCE, check=False).returncode == 0:
            return path
    return None


class NavigatedError(Exception):
    """The page of a call was replaced by another one before its answer."""


class Browser:
    """One page in its own browser; for a with statement. ``faults`` are errors of the page's scripts."""

    def __init__(self, path):
        self._path = path
        self._last = 0
        self._waiting = b""
        self.faults = []

    def __enter__(self):
        self._folder = tempfile.mkdtemp(prefix="browser-")
        (in_read, self._to), (self._from, out_write) = os.pipe(), os.pipe()
        command = ["bash", "-c", f'exec "$@" 3<&{in_read} 4>&{out_write}', "-", self._path, *OPTIONS]
        command += [f"--user-data-dir={self._folder}", "about:blank"]
        quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self._process = subprocess.Popen(command, pass_fds=(in_read, out_write), start_new_session=True, **quiet)
        os.close(in_read)
        os.close(out_write)
        self._session = None
        targets = wait_until(self._pages, "the page")
        self._session = self.call("Target.attachToTarget", targetId=targets[0], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        return self

    def __exit__(self, *_error):
        self._session = None
        with suppress(OSError, AssertionError):
            self.call("Browser.close")
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(self._process.pid, 9)
            self._process.wait()
        os.close(self._to)
        os.close(self._from)
        shutil.rmtree(self._folder, ignore_errors=True)

    def _pages(self):
        return [one["targetId"] for one in self.call("Target.getTargets")["targetInfos"] if one["type"] == "page"]

    def call(self, method, **parameters):
        """Call a method of the protocol and return its result."""
        self._last += 1
        number = self._last
        message = {"id": number, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        os.write(self._to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._read()
            if answer.get("id") == number:
                if "navigated" in answer.get("error", {}).get("message", ""):
                    raise NavigatedError(method)
                assert "error" not in answer, f"{method}: {answer['error']}"
                return answer["result"]

    def _read(self):
        end = time.monotonic() + PATIENCE
        while b"\0" not in self._waiting:
            with selectors.DefaultSelector() as selector:
                selector.register(self._from, selectors.EVENT_READ)
                assert selector.select(end - time.monotonic()), "the browser does not answer"
            more = os.read(self._from, 1 << 16)
            assert more, "the browser has ended"
            self._waiting += more
        text, _, self._waiting = self._waiting.partition(b"\0")
        message = json.loads(text.decode())
        if message.get("method") == "Runtime.exceptionThrown":
            details = message["params"]["exceptionDetails"]
            self.faults.append(details.get("exception", {}).get("description", details["text"]))
        if message.get("method") == "Log.entryAdded" and message["params"]["entry"]["level"] == "error":
            self.faults.append(message["params"]["entry"]["text"])
        return message

    # ---- the page ---------------------------------------------------------------------------------------------------

    def size(self, width, height):
        """Set the window's size in pixels."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def open(self, address):
        """Open a page and wait until it has loaded."""
        self.call("Page.navigate", url=address)
        self.wait_for(f"location.href === {json.dumps(address)} && document.readyState === 'complete'")

    def reload(self):
        """Load the page again and wait until it has loaded."""
        self.run("window.isOld = true")
        self.call("Page.reload")
        self.wait_for("window.isOld === undefined && document.readyState === 'complete'")

    def run(self, script):
        """Return the value of an expression on the page."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer.get("exceptionDetails")
        return answer["result"].get("value")

    def wait_for(self, script):
        """Wait until an expression on the page holds, also while another page loads, and return its value."""

        def value():
            with suppress(NavigatedError):
                return self.run(script)
            return None

        return wait_until(value, script)

    def text(self, selector):
        """Return the visible text of the first element of a selector."""
        return self.run(f"document.querySelector({json.dumps(selector)}).innerText")

    def texts(self, selector):
        """Return the texts of all elements of a selector."""
        return self.run(f"[...document.querySelectorAll({json.dumps(selector)})].map((one) => one.textContent)")

    def press(self, key, selector=None):
        """Press a key, in an element if one is named."""
        if selector is not None:
            self.run(f"document.querySelector({json.dumps(selector)}).focus()")
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=_CODES[key])

    def click(self, selector):
        """Click on the middle of an element."""
        place = (
            f"(() => {{ const one = document.querySelector({json.dumps(selector)});"
            " one.scrollIntoView({block: 'center'}); const box = one.getBoundingClientRect();"
            " const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];"
            " return [x, y, one.contains(document.elementFromPoint(x, y))]; })()"
        )
        x, y, seen = self.run(place)
        assert seen, f"{selector} is covered by something else"
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def push(self, text, within):
        """Click on the last visible button of this text, as soon as it is there."""
        buttons = f"[...document.querySelectorAll({json.dumps(within + ' button')})]"
        found = f"{buttons}.filter((one) => one.textContent === {text!r} && one.offsetParent !== null).pop()"
        self.wait_for(f"{found} !== undefined")
        self.run(f"{found}.dataset.pushed = ''")
        self.click("[data-pushed]")
        self.run("delete document.querySelector('[data-pushed]')?.dataset.pushed")

    def choose(self, selector, value):
        """Choose an option of a select element, as soon as it is offered."""
        select = f"document.querySelector({json.dumps(selector)})"
        self.wait_for(f"[...{select}.options].some((one) => one.value === {value!r})")
        self.run(f"{select}.value = {value!r}; {select}.dispatchEvent(new Event('change'))")


_CODES = {"ArrowLeft": 37, "ArrowRight": 39, "Home": 36, "End": 35}
