"""Make doc/images/fleet_page.png, fleet_rviz.png and fleet_report.png: three robots on the page, in rviz, in a report.

Run it in the built workspace: ./dev exec python3 doc/make_fleet_pictures.py
It plays the demo of the fleet in real time, which takes five minutes or more.  Needs Chromium and, like
make_rviz_picture.py, Xvfb and rviz.
"""

import base64
import io
import os
import re
import subprocess
import sys
from pathlib import Path

from make_page_picture import open_live
from make_rviz_picture import DISPLAY, SCREEN, free_port, running, save, take_picture, wait_for
from PIL import Image

DOC = Path(__file__).resolve().parent
IMAGES = DOC / "images"
sys.path.insert(0, str(DOC.parent / "test" / "unit"))

import browser  # noqa: E402

LIVE, REPORT = (1180, 1520), (1180, 1720)  # pixels of width and height
NOW = "live.model.seconds > 40 && live.model.actions.filter(({ ended }) => ended === null).length > 1"
ACTING = "model.actions.filter(({ begun, ended }) => begun + 1 < time && time < ended - 1).length"
BEST = f"""const counts = [...Array(Math.floor(model.seconds)).keys()].map((time) => time < 40 ? 0 : {ACTING});
player.seek(counts.indexOf(Math.max(...counts)));"""


def take_page(page, name):
    save(Image.open(io.BytesIO(base64.b64decode(page.call("Page.captureScreenshot")["data"]))), IMAGES / name)


def main():
    path, port = browser.found(), free_port()
    if path is None:
        sys.exit("there is no browser")
    given = {**os.environ, "DISPLAY": DISPLAY, "LIBGL_ALWAYS_SOFTWARE": "1"}
    shown = ["speed:=1", "rviz:=true", "web:=true", f"port:={port}"]
    with running("Xvfb", DISPLAY, "-screen", "0", SCREEN), running(
        "rosrun", "rosoclingo", "demo", "fleet", *shown, env=given, stdout=subprocess.PIPE, text=True
    ) as demo, browser.Browser(path) as page:
        page.size(*LIVE)
        open_live(page, port)
        wait_for(lambda: page.run(NOW), "two robots at work")
        take_page(page, "fleet_page.png")
        take_picture(DISPLAY, IMAGES / "fleet_rviz.png")
        report = re.search(r"^report: (.+)$", demo.stdout.read(), re.MULTILINE)
        if report is None:
            sys.exit("the demo wrote no report")
        page.size(*REPORT)
        page.open(Path(report.group(1)).as_uri())
        page.run(BEST)
        take_page(page, "fleet_report.png")


if __name__ == "__main__":
    main()
