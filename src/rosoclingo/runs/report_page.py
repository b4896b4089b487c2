"""Reports and the live page: each is one HTML file with all styles and scripts of ``web/``."""

import base64
import hashlib
import json
from pathlib import Path
from typing import Any, Mapping, Sequence, Tuple

#: The scripts of a report and of the live page, in order.
_VIEWS = (
    "model.js",
    "draw.js",
    "map_view.js",
    "timeline_view.js",
    "tables_view.js",
    "charts_view.js",
    "player.js",
)
SCRIPTS = (*_VIEWS, "report.js")
LIVE_SCRIPTS = (*_VIEWS, "orders_view.js", "operator_view.js", "live.js")
STYLE = "page.css"
PAGE, LIVE_PAGE, VIEWS = "report.html", "live.html", "views.html"


def report_page(run: Mapping[str, Any], web: Path) -> str:
    """Return the page of a run (see :meth:`RunView.changes`), with the front-end files of the folder ``web``.

    No text of the run is interpreted as HTML, and only the scripts of ``web`` can run.
    """
    page, policy = _page(web, PAGE, SCRIPTS)
    policy = f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
    return _with(page, policy=policy, run=f'<script type="application/json" id="run">{_json(run)}</script>')


def live_page(web: Path) -> Tuple[str, str]:
    """Return the live page, which loads the run from the server, and its Content-Security-Policy."""
    return _page(web, LIVE_PAGE, LIVE_SCRIPTS)


def _page(web: Path, name: str, scripts: Sequence[str]) -> Tuple[str, str]:
    """Return a page with its style and scripts, and a policy that permits only these."""
    page, views, style = ((web / one).read_text(encoding="utf-8") for one in (name, VIEWS, STYLE))
    script = "\n".join((web / one).read_text(encoding="utf-8") for one in scripts)
    policy = f"default-src 'none'; img-src data:; style-src {_hash(style)}; script-src {_hash(script)}"
    views, style, script = views.rstrip("\n"), f"<style>{style}</style>", f"<script>{script}</script>"
    return _with(page, views=views, style=style, script=script), policy


def _with(page: str, **parts: str) -> str:
    """Return a page with parts in place of the comments with their names."""
    for place, text in parts.items():
        before, _, after = page.partition(f"<!-- {place} -->")
        page = before + text + after
    return page


def _json(run: Mapping[str, Any]) -> str:
    """Return JSON that cannot end a script element."""
    text = json.dumps(run, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _hash(text: str) -> str:
    return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii") + "'"
