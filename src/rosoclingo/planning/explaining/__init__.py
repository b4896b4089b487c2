"""Explanations of infeasibility: the rules and facts that exclude a plan, found by relaxing constraints."""
