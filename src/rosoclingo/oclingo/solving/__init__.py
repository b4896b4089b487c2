"""The incremental solver: updates in, answers out, growing the horizon.

Its loop in short, which the tests run on the lift of doc/oclingo_service.md::

    import clingo

    class Loop:
        # The program is grounded step by step, and searched at the last grounded step: the horizon.

        def __init__(self, program):
            self.program = program
            self.control = clingo.Control(program.arguments())
            program.load_into(self.control)
            self.control.ground([("base", [])])
            self.horizon = 0

        def update(self, update):
            # Take facts for externals and constraints, then look further and further ahead until there is an answer.
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
            # One step more; of the volatile parts, which say what a plan has to reach, only the last one holds.
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

reactive_solver.py extends this class by bounds and time limits. stream_state.py is a pure fold of the updates;
reactive_grounding.py holds the clingo control and follows the state. clasp_search.py runs searches that can be stopped,
and definitions.py adds rules to the control through its backend. The solver of plans is in rosoclingo.planning.
"""
