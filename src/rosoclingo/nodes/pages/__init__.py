"""A run on pages: as a report, and live."""
