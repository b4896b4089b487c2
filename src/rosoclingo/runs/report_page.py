"""A run as one HTML file that needs nothing else: views, figures and a slider, drawn by the scripts of ``web/``."""

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
LIVE_SCRIPTS = (*_VIEWS, "orders_view.js", "live.js")
STYLE = "page.css"
PAGE, LIVE_PAGE, VIEWS = "report.html", "live.html", "views.html"


def report_page(run: Mapping[str, Any], web: Path) -> str:
    """Return the page of a run (see :meth:`RunView.changes`), with the front-end files of the folder ``web``.

    Whatever texts the run has, none is read as HTML, and no other script than those of ``web`` is run.
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
    """Return the page of a system that runs, which asks for its scripts and for the run."""
    return _page(web, LIVE_PAGE, {})


def _page(web: Path, name: str, parts: Mapping[str, str]) -> str:
    """Return a page with its parts, and with what all pages show."""
    page = (web / name).read_text(encoding="utf-8")
    views = (web / VIEWS).read_text(encoding="utf-8").rstrip("\n")
    for place, text in {"views": views, **parts}.items():
        before, _, after = page.partition(f"<!-- {place} -->")
        page = before + text + after
    return page


def _json(run: Mapping[str, Any]) -> str:
    """Return JSON in which nothing ends a script element."""
    text = json.dumps(run, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _hash(text: str) -> str:
    return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii") + "'"
