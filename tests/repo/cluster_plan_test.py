"""Tests bench/cluster_plan.py: the model by hand, its limits, and the command."""

import dataclasses
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench"))
from cluster_plan import Machine, Work, broken, cost, limits, most_vertices, plan  # noqa: E402

WORK = Work(bytes=1000, assemble=1e-6, divide=2e-6, set_up=3e-6, iterations=10, fine_traffic=500, cycle_traffic=100, cycles=5, efficiency=0.5,
            messages=100, message_bytes=1e6, reductions=20, measured_ranks=16, measured_cycles=2.5, measured_part=2500, file_bytes=50)
MACHINE = Machine(ranks=4, memory=1e9, memory_bandwidth=1e10, core_speed=2, latency=1e-6, network_bandwidth=1e9,
                  file_bandwidth=1e9, price=36)


class ClusterPlan(unittest.TestCase):
    def test_by_hand(self):
        found = plan(1_600_000, 4, MACHINE, WORK)  # 16 ranks of 100,000 vertices
        self.assertEqual((found.ranks, found.part, found.memory), (16, 100_000, 4e8))
        expected = {
            "file": 2 * 8e7 / 1e9, "assemble": 0.05, "divide": 0.1, "set-up": 0.15,
            "solve: memory": 10 * 400_000 * 1000 / 5e9,
            "solve: latency": 2 * 10 * 1e-6 * (100 + 20 * 4),
            "solve: bytes sent": 2 * 10 * 1e6 * (100_000 / 2500) ** 0.5 * 4 / 1e9,
        }
        self.assertEqual(set(found.seconds), set(expected))
        for stage, seconds in expected.items():
            self.assertAlmostEqual(found.seconds[stage], seconds, msg=stage)
        self.assertAlmostEqual(cost(found, 4, MACHINE), sum(expected.values()) * 4 / 100)

    def test_refuses_numbers_that_make_no_sense(self):
        for arguments in (["1e8", "0"], ["nan", "4"], ["-5", "4"], ["1e8", "4", "--ranks", "2.5"], ["1e8", "4", "--price", "-3"],
                          ["1e8", "4", "--work-measured-ranks", "1"]):
            refused = subprocess.run([sys.executable, ROOT / "bench" / "cluster_plan.py", *arguments], capture_output=True, text=True)
            self.assertEqual(refused.returncode, 2, arguments)
            self.assertIn("is not a", refused.stderr)

    def test_one_rank_sends_nothing(self):
        found = plan(1000, 1, dataclasses.replace(MACHINE, ranks=1), WORK)
        self.assertEqual(found.seconds["solve: latency"], 0)
        self.assertEqual(found.seconds["solve: bytes sent"], 0)

    def test_at_a_fixed_size_per_machine_only_the_network_and_the_file_take_longer(self):
        few, many = plan(1e6, 4, MACHINE, WORK), plan(16e6, 64, MACHINE, WORK)
        for stage in few.seconds:
            if stage in ("file", "solve: latency", "solve: bytes sent"):
                self.assertGreater(many.seconds[stage], few.seconds[stage], stage)
            else:
                self.assertAlmostEqual(many.seconds[stage], few.seconds[stage], msg=stage)

    def test_memory(self):
        self.assertEqual(most_vertices(MACHINE, WORK, share=1), 1e6)
        self.assertEqual(most_vertices(MACHINE, WORK), 5e5)

    def test_limits(self):
        work = dataclasses.replace(WORK, unknowns=2, entries=100)
        of_unknowns, of_faces, of_vertices = (2**31 - 1) // 6, 2**30 - 1, 2**31 - 1
        self.assertEqual([most for most, _ in limits(1000, work)], [of_unknowns, of_faces, of_vertices, (2**31 - 1) * 10])
        self.assertEqual(limits(2, work)[0][0], 42_949_672)  # entries of two ranks
        self.assertEqual([len(broken(most + more, 1000, work)) for most in (of_unknowns, of_faces, of_vertices) for more in (0, 1)],
                         [0, 1, 1, 2, 2, 3])
        self.assertIn("Beyond 357,913,941 vertices the unknowns need", broken(of_faces, 1000, work)[0])

    def test_command(self):
        def lines(*arguments):
            done = subprocess.run([sys.executable, ROOT / "bench/cluster_plan.py", *arguments], capture_output=True, text=True,
                                  check=True)
            return dict(line.strip("| ").split(" | ") for line in done.stdout.splitlines() if line.startswith("|")), done.stdout
        usual, text = lines("1e8", "16")
        self.assertEqual(usual["ranks"], "1,024")
        self.assertNotIn("does not fit", text)
        self.assertNotIn("Beyond", text)
        slower, _ = lines("1e8", "16", "--memory-bandwidth", "30")
        self.assertAlmostEqual(float(slower["solve: memory, s"]), 10 * float(usual["solve: memory, s"]), delta=1)
        self.assertIn("does not fit", lines("1e9", "2")[1])
        self.assertIn("64-bit indices", lines("1e9", "256")[1])
        self.assertIn("is refused", lines("2147483648", "512")[1])


if __name__ == "__main__":
    unittest.main()
