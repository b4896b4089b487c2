"""What is said and kept of a run: scenarios, accounts (pure)."""
