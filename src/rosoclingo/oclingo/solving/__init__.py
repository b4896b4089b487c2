"""The incremental solver: it answers stream updates and increases the horizon as needed.

A minimal version of its loop, which a test runs on the lift of doc/oclingo_service.md::

    import clingo

    class Loop:
        # Grounds a program step by step and searches at the last grounded step: the horizon.

        def __init__(self, program):
            self.program = program
            self.control = clingo.Control(program.arguments())
            program.load_into(self.control)
            self.control.ground([("base", [])])
            self.horizon = 0

        def update(self, update):
            # Assign externals, add constraints, then increase the horizon until there is an answer.
            while self.horizon < update.step:
                self.grow()
            for _, statement in update.sections():
                if statement.head is not None:
                    self.control.assign_external(statement.head, True)
                else:
                    with self.control.backend() as backend:
                        backend.add_rule([], [self.literal(one) for one in statement.body])
            answer = self.search()
            while answer is None:
                self.grow()
                answer = self.search()
            return answer

        def grow(self):
            # Ground the next step. Only its volatile part holds, with the goals of the plan.
            self.control.assign_external(self.program.guard(1, self.horizon), False)
            self.horizon += 1
            step = clingo.Number(self.horizon)
            self.control.ground([("cumulative", [step]), ("volatile", [step])])
            self.control.assign_external(self.program.guard(1, self.horizon), True)

        def search(self):
            with self.control.solve(yield_=True) as handle:
                return next((model.symbols(shown=True) for model in handle), None)

        def literal(self, one):
            atom = self.control.symbolic_atoms[one.atom]
            return atom.literal if one.positive else -atom.literal

reactive_solver.py extends this class by bounds and time limits. stream_state.py is a pure fold of the updates.
stepwise_grounding.py owns the clingo control and grounds step by step, also for the planner in rosoclingo.planning;
reactive_grounding.py follows the state in place. clasp_search.py runs interruptible searches, and definitions.py adds
rules to the control through its backend.
"""
