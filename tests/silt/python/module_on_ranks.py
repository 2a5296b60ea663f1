#!/usr/bin/python3
"""module_on_ranks.py SILT FOLDER: the module `silt` in FOLDER on several ranks, beside other users of MPI and in its own
process."""
import subprocess
import unittest

from module_test import MODULE, ModuleTest

import numpy as np
from silt_test import ENVIRONMENT, SILT


class Ranks(ModuleTest):
    def test_same_state_on_any_ranks(self):
        program = """
            import numpy, silt
            simulation = silt.Simulation(".", unset=["domain.blocks"])
            for step in range(20):
                simulation.add_force(1, [0, 0, 1e-3 * step])
                simulation.step()
            numpy.savez(f"{simulation.ranks}.{simulation.rank}", box=simulation.box, ids=simulation.bodies.id,
                        **{name: simulation.field(name) for name in ("velocity", "vorticity", "density")})
            said = simulation.hash()  # every rank asks
            if simulation.rank == 0:
                print(said)
            """
        said = {ranks: self.script(program, ranks) for ranks in (1, 3, 4)}
        for result in said.values():
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertRegex(result.stdout, r"^[0-9a-f]{16}\n$")
            self.assertEqual(result.stdout, said[1].stdout)
        alone = np.load(self.case / "1.0.npz")
        for ranks in (3, 4):
            parts = [np.load(self.case / f"{ranks}.{rank}.npz") for rank in range(ranks)]
            self.assertEqual(sorted(i for part in parts for i in part["ids"]), [1, 2])
            self.assertEqual(sum(np.prod(part["box"][1] - part["box"][0]) for part in parts), 24 * 16 * 16)
            for part in parts:
                cells = tuple(slice(*ends) for ends in part["box"].T)
                for name in ("velocity", "vorticity", "density"):
                    self.assertTrue((alone[name][cells] == part[name]).all(), (ranks, name))

    def test_bodies_by_id_are_alike_on_every_rank(self):
        program = """
            import numpy, silt
            simulation = silt.Simulation(".", unset=["domain.blocks"])
            simulation.run(5)
            all, two = simulation.bodies.by_id(), simulation.bodies.by_id([2, 1])
            assert list(all["id"]) == [1, 2] and list(two["id"]) == [2, 1]
            for name, values in all.items():
                assert (values[::-1] == two[name]).all(), name
                assert not values.flags.writeable
                here = [list(all["id"]).index(id) for id in simulation.bodies.id]
                assert (values[here] == getattr(simulation.bodies, name)).all(), name
            try:
                simulation.bodies.by_id([1, 7])
            except ValueError as error:
                assert str(error) == "there is no body 7"
            numpy.save(f"{simulation.ranks}.{simulation.rank}", all["position"])
            """
        for ranks in (1, 3, 4):
            result = self.script(program, ranks)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            for rank in range(ranks):
                self.assertTrue((np.load(self.case / f"{ranks}.{rank}.npy") == np.load(self.case / "1.0.npy")).all(), (ranks, rank))

    def test_an_error_on_one_rank_ends_all(self):
        result = self.script("""
            import silt
            with silt.Simulation(".", out="driven") as simulation:
                simulation.run(5)
                if simulation.rank == 1:
                    raise RuntimeError("this rank is ill")
                simulation.run(55)
            """, 2)
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("this rank is ill", result.stderr)

    def test_changes_are_refused_on_every_rank(self):
        program = """
            import silt
            simulation = silt.Simulation(".", unset=["domain.blocks"])
            before = simulation.hash()
            for call in (lambda: simulation.set_pose(1, [8, 8, 1]), lambda: simulation.set_pose(1, [18, 8, 8]),
                         lambda: simulation.set_velocity(1, [0.5, 0, 0]), lambda: simulation.add_force(1, [1e9, 0, 0]),
                         lambda: simulation.add_force(3, [0, 0, 0])):
                try:
                    call()
                except ValueError as error:
                    print(f"{error}\\n", end="", flush=True)
            assert simulation.hash() == before
            simulation.run(3)
            """
        alone = self.script(program, 1)
        self.assertEqual((alone.returncode, alone.stderr), (0, ""))
        self.assertEqual(len(alone.stdout.splitlines()), 5, alone.stdout)
        for ranks in (3, 4):
            result = self.script(program, ranks)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertEqual(sorted(result.stdout.splitlines()), sorted(ranks * alone.stdout.splitlines()))

    def test_an_instruction_set_that_there_is_not_is_refused(self):
        for name, asked, known in (("SILT_ISA", "avx3", "portable, avx2 or avx512"), ("SILT_LAST_CACHE", "nearby", "near or far")):
            done = subprocess.run(["/usr/bin/python3", "-c", "import silt"], capture_output=True, text=True,
                                  env={**ENVIRONMENT, "PYTHONPATH": str(MODULE), name: asked})
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(f"ImportError: the environment variable {name} is '{asked}'; it must be {known}", done.stderr)

    def test_errors_of_a_case_come_on_every_rank(self):
        result = self.script("""
            import silt
            try:
                silt.Simulation(".", set=["fluid.relaxation_time=0.4"])
            except silt.CaseError as error:
                assert "relaxation_time" in str(error)
                print("caught\\n", end="", flush=True)
            """, 2)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, 2 * "caught\n", ""))

    def test_mpi_of_somebody_else(self):
        """mpi4py, which comes with VTK, starts and ends MPI; with it simulations end, wherever they are kept."""
        result = self.script("""
            from mpi4py import MPI
            import silt
            simulation = silt.Simulation(".")
            simulation.run(2)
            MPI.Finalize()
            try:
                simulation.bodies.position
            except RuntimeError as error:
                print(f"{error}\\n", end="", flush=True)
            """, 2)
        ended = "the simulation has ended: MPI is finalised\n"
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, 2 * ended, ""))

    def test_parameters_of_its_mpi_are_not_left_to_others(self):
        """The settings of silt/run/start_mpi.cpp for a process alone are for this one; a program that a
        script starts beside it runs."""
        result = self.script(f"""
            import subprocess, silt
            simulation = silt.Simulation(".")
            subprocess.run({[SILT, "run", "."]!r}, check=True, stdout=subprocess.DEVNULL)
            seen = subprocess.run(["env"], capture_output=True, text=True).stdout.splitlines()
            print(*(line for line in seen if line.startswith("OMPI_MCA_")), sep="\\n")
            """, 1)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for parameter in ("btl", "pml", "ess_singleton_isolated", "orte_create_session_dirs"):
            self.assertNotIn(f"OMPI_MCA_{parameter}=", result.stdout)


if __name__ == "__main__":
    unittest.main()
