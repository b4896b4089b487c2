"""Make doc/images/fleet_page.png and fleet_report.png: three robots on the live page and in a report.

Run it in the built workspace: ./dev exec python3 doc/make_fleet_pictures.py
It plays the demo of the fleet in real time, which takes five minutes or more.  Needs Chromium.
"""

import base64
import io
import re
import subprocess
import sys
from pathlib import Path

from make_page_picture import open_live
from make_rviz_picture import free_port, running, wait_for
from PIL import Image

DOC = Path(__file__).resolve().parent
sys.path.insert(0, str(DOC.parent / "test" / "unit"))

import browser  # noqa: E402

SIZE = 1180, 1520
NOW = "live.model.seconds > 40 && live.model.actions.filter(({ ended }) => ended === null).length > 1"
ACTING = "model.actions.filter(({ begun, ended }) => begun + 1 < time && time < ended - 1).length"
BEST = f"""const counts = [...Array(Math.floor(model.seconds)).keys()].map((time) => {ACTING});
player.seek(counts.indexOf(Math.max(...counts)));"""


def take_picture(page, name):
    path = DOC / "images" / name
    picture = Image.open(io.BytesIO(base64.b64decode(page.call("Page.captureScreenshot")["data"])))
    picture.convert("P", palette=Image.ADAPTIVE, colors=256).save(path, optimize=True)
    print(f"{path}: {path.stat().st_size // 1000} kB")


def main():
    path, port = browser.found(), free_port()
    if path is None:
        sys.exit("there is no browser")
    command = ["rosrun", "rosoclingo", "demo", "fleet", "speed:=1", "web:=true", f"port:={port}"]
    with running(*command, stdout=subprocess.PIPE, text=True) as demo, browser.Browser(path) as page:
        page.size(*SIZE)
        open_live(page, port)
        wait_for(lambda: page.run(NOW), "two robots at work")
        take_picture(page, "fleet_page.png")
        report = re.search(r"^report: (.+)$", demo.stdout.read(), re.MULTILINE)
        if report is None:
            sys.exit("the demo wrote no report")
        page.open(Path(report.group(1)).as_uri())
        page.run(BEST)
        take_picture(page, "fleet_report.png")


if __name__ == "__main__":
    main()
