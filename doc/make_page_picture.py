"""Make doc/images/page.png: the live page of the house while the robot works, in a real browser.

Run it in the built workspace: ./dev exec python3 doc/make_page_picture.py
It starts the house with a master of its own, and sends two orders from the page.  Needs Chromium.
"""

import base64
import os
import socket
import subprocess
import sys
from pathlib import Path

from make_rviz_picture import free_port, running, wait_for

DOC = Path(__file__).resolve().parent
sys.path.insert(0, str(DOC.parent / "test" / "unit"))

import browser  # noqa: E402

PICTURE = DOC / "images" / "page.png"
SIZE = 1180, 1240
FORM = "document.querySelector('#orders form')"
ORDERS = (("cup", "study"), ("newspaper", "bedroom"))
MOMENT = "document.getElementById('now').textContent === 'Drives to living room'"


def main():
    path, master, port = browser.found(), free_port(), free_port()
    if path is None:
        sys.exit("there is no browser")
    house = ["roslaunch", "-p", str(master), "rosoclingo", "house.launch", "web:=true", f"port:={port}"]
    given = {**os.environ, "ROS_MASTER_URI": f"http://localhost:{master}"}
    with running(*house, env=given, stdout=subprocess.DEVNULL), browser.Browser(path) as page:
        page.size(*SIZE)
        open_live(page, port)
        for thing, room in ORDERS:
            page.wait_for(f"{FORM}?.elements.thing.options.length > 3")
            page.run(f"{FORM}.elements.thing.value = '{thing}'; {FORM}.elements.room.value = '{room}'")
            page.click("#orders form button")
            page.wait_for(f"document.getElementById('messages').textContent.includes('{thing}')")
        page.wait_for(MOMENT)
        PICTURE.write_bytes(base64.b64decode(page.call("Page.captureScreenshot")["data"]))
    print(f"{PICTURE}: {PICTURE.stat().st_size // 1000} kB")


def open_live(page, port):
    """Open the page once its node serves it, and wait for its data."""
    with socket.socket() as probe:
        wait_for(lambda: not probe.connect_ex(("127.0.0.1", port)), "the page")
    page.open(f"http://127.0.0.1:{port}/")
    page.wait_for("typeof live !== 'undefined' && document.getElementById('connection').textContent === 'Live'")


if __name__ == "__main__":
    main()
