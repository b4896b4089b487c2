"""Runs of a core: events, views, accounts, recordings, replay and scenarios (pure)."""
