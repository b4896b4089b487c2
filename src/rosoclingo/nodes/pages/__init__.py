"""Web pages of a run: the report and the live page."""
