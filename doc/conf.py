"""Sphinx configuration of the site that ``./dev docs`` builds: these pages, and API pages of the docstrings."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = {"index": "README.md", "contributing": "CONTRIBUTING.md"}
"""Pages of the site whose text is at the root of the repository."""

project = "rosoclingo"
author = "rosoclingo developers"
release = re.search(r"<version>(.*)</version>", (ROOT / "package.xml").read_text()).group(1)
html_title = f"rosoclingo {release}"
html_theme = "furo"
exclude_patterns = ["README.md"]  # the index for readers of the repository
templates_path = ["_templates"]

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.napoleon"]
myst_heading_anchors = 4
autodoc_member_order = "bysource"
napoleon_use_ivar = True  # attributes of a named tuple are documented once, in the text of the class
suppress_warnings = ["ref.python"]  # names of attributes that several classes have are no links


def read_page(_app, name, source):
    """Take the text of a page at the root, and let links between pages lead to pages of the site."""
    text = source[0]
    if name in PAGES:
        links = re.compile(r"\]\((?!\w+:|#)(doc/)?")
        text = links.sub(lambda link: "](" if link[1] else "](../", (ROOT / PAGES[name]).read_text()) + text
    for page, file in PAGES.items():
        text = text.replace(f"](../{file}", f"]({page}.md")
    source[0] = re.sub(r"\]\(README\.md(#[\w-]+)?\)", "](index.md)", text)


def setup(app):
    """Connect the event handler."""
    app.connect("source-read", read_page)
