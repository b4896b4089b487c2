"""The reactive ASP solver: online progression, reactive programs, answers (pure)."""
