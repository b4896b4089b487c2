"""What a plan does in another order: plans that may be shorter, for the solver to tell whether they are plans.

Nothing is known of the domain: deeds.py reads in the plan what there is to do and which ways lead from one place to
another, ruin_and_recreate.py looks for shorter orders, and other_orders.py makes plans of them.
"""
