"""Make doc/images/report.png: a moment in the report of the paper's run, in a real browser.

Run it in the built workspace: ./dev exec python3 doc/make_report_picture.py
It plays the demo, which writes the report.  Needs Chromium.
"""

import base64
import re
import subprocess
import sys
from pathlib import Path

DOC = Path(__file__).resolve().parent
sys.path.insert(0, str(DOC.parent / "test" / "unit"))

import browser  # noqa: E402

PICTURE = DOC / "images" / "report.png"
SIZE = 1180, 1160
MOMENT = "model.actions.find(({ action }) => model.words[action].words === 'drives to office3').begun + 3"


def main():
    done = subprocess.run(["rosrun", "rosoclingo", "demo"], capture_output=True, text=True, check=False)
    report = re.search(r"^report: (.+)$", done.stdout, re.MULTILINE)
    path = browser.found()
    if report is None or path is None:
        sys.exit("there is no browser" if report else f"there is no report: {done.stdout[-2000:]}{done.stderr[-2000:]}")
    with browser.Browser(path) as page:
        page.size(*SIZE)
        page.open(Path(report.group(1)).as_uri())
        page.run(f"player.seek({MOMENT})")
        PICTURE.write_bytes(base64.b64decode(page.call("Page.captureScreenshot")["data"]))
    print(f"{PICTURE}: {PICTURE.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main()
