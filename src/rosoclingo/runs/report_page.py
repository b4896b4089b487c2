"""A run as one self-contained HTML file: views, figures and a slider, drawn by the scripts of ``web/``."""

import base64
import hashlib
import json
from pathlib import Path
from typing import Any, Mapping

__all__ = ["LIVE_SCRIPTS", "SCRIPTS", "STYLE", "live_page", "report_page"]

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
    script = "\n".join((web / name).read_text(encoding="utf-8") for name in SCRIPTS)
    style = (web / STYLE).read_text(encoding="utf-8")
    policy = f"default-src 'none'; img-src data:; style-src {_hash(style)}; script-src {_hash(script)}"
    parts = {
        "policy": f'<meta http-equiv="Content-Security-Policy" content="{policy}">',
        "style": f"<style>{style}</style>",
        "run": f'<script type="application/json" id="run">{_json(run)}</script>',
        "script": f"<script>{script}</script>",
    }
    return _page(web, PAGE, parts)


def live_page(web: Path) -> str:
    """Return the live page, which loads its scripts and the run from the server."""
    return _page(web, LIVE_PAGE, {})


def _page(web: Path, name: str, parts: Mapping[str, str]) -> str:
    """Return a page with its parts, and with the views that all pages share."""
    page = (web / name).read_text(encoding="utf-8")
    views = (web / VIEWS).read_text(encoding="utf-8").rstrip("\n")
    for place, text in {"views": views, **parts}.items():
        before, _, after = page.partition(f"<!-- {place} -->")
        page = before + text + after
    return page


def _json(run: Mapping[str, Any]) -> str:
    """Return JSON that cannot end a script element."""
    text = json.dumps(run, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _hash(text: str) -> str:
    return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii") + "'"
