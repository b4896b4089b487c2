"""Explanations why there is no plan: the rules and facts that exclude one, found with relaxed constraints."""
