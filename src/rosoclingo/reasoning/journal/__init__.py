"""The journal: a write-ahead record of the core's state, from which a restarted core resumes.

The state is on disk before any message that depends on it is sent. :mod:`rosoclingo.reasoning.core` itself does not
depend on the journal.
"""
