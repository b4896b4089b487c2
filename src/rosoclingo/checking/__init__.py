"""What may be wrong with a program before it drives: lint, trial plans, verification."""
