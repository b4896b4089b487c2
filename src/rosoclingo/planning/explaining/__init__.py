"""Why there is no plan: which rules and facts forbid it, found out on a program whose rules can be let go."""
