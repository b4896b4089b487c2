"""The reactive solver: updates in, answers out, growing the horizon.

Simplified to its loop it is this, which runs (the tests play the lift of doc/oclingo_service.md with it):

    import clingo

    class Loop:
        # The program is ground step by step, and searched at the last step that is ground: the horizon.

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

What the files beside this one add: solver.py is that class, with bounds, time limits and an update taken as a whole
or not at all; transaction.py is an update on its way in; grounding.py is clingo with the program in it,
clasp_search.py asks clingo what can be stopped, atom_table.py has the atoms and, with horizon.py, the rules that are
added behind clingo's grounder; horizon_search.py asks below the last step as well, for shortest plans; plan_search.py
is content with what is found in time, improvement.py shortens it while it is carried out, with reordered_plans.py;
trimming.py removes superfluous actions; inquiry.py solves without some facts that were asserted; compaction.py
removes the past; stream_log.py is the log of a solver's updates and plans, from which stream_state.py follows.
"""
