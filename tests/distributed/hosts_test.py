#!/usr/bin/env python3
"""Runs meshgraft-mpi on several hosts, which are network namespaces of this machine that the test makes.

    hosts_test.py MESHGRAFT MESHGRAFT_MPI MPIRUN [TEST…]
"""

import os
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from cluster_scene import MPI_PROGRAM, MPIRUN, Mesh, largest_difference, read_ply, run_ranks, write_edit

DISC = {"sphere": {"centre": [0.5, 0.5, 0], "radius": 0.12}}
STEP = {"fixed": {"half_space": {"point": [0.1, 0, 0], "normal": [-1, 0, 0]}},
        "handles": [{"name": "disc", "select": DISC, "pose": {"translate": [0, 0, 0.2]}}]}


def ip(*arguments):
    return subprocess.run(["ip", *arguments], capture_output=True, text=True, check=True)


class Network:
    """A bridge with hosts. Each host is a namespace with an address and a virtual cable to the bridge."""

    def __init__(self, count):
        self.bridge, self.hosts, self.addresses = f"mg{os.getpid() % 100000}", [], []
        try:
            ip("link", "add", self.bridge, "type", "bridge")
            ip("link", "set", self.bridge, "up")
            for k in range(count):
                name = f"{self.bridge}h{k}"
                ip("netns", "add", name)
                self.hosts.append(name)
                self.addresses.append(f"10.213.47.{k + 1}")
                ip("link", "add", name, "type", "veth", "peer", "name", "eth0", "netns", name)
                ip("link", "set", name, "master", self.bridge, "up")
                ip("-n", name, "address", "add", f"{self.addresses[-1]}/24", "dev", "eth0")
                ip("-n", name, "link", "set", "eth0", "up")
                ip("-n", name, "link", "set", "lo", "up")
                # Data that nobody acknowledges is given up in seconds, as keepalive probes are.
                ip("netns", "exec", name, "sh", "-c", "echo 3 > /proc/sys/net/ipv4/tcp_retries2")
        except (OSError, subprocess.CalledProcessError) as error:
            self.remove()
            raise unittest.SkipTest("this user can make no network namespaces") from error

    def cut_off(self, k):
        ip("link", "set", self.hosts[k], "down")

    def remove(self):
        for name in self.hosts:
            subprocess.run(["ip", "netns", "delete", name], capture_output=True)
        subprocess.run(["ip", "link", "delete", self.bridge], capture_output=True)


class Hosts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.path, self.output = self.folder / "mesh.ply", self.folder / "out.ply"
        self.log = open(self.folder / "log", "w+")
        self.addCleanup(self.log.close)
        self.network = Network(3)
        self.addCleanup(self.network.remove)
        self.agent = self.folder / "agent"
        cases = "\n".join(f"  {address}) host={host};;"
                          for address, host in zip(self.network.addresses, self.network.hosts))
        self.agent.write_text(f'#!/bin/sh\nname=$1\nshift\ncase "$name" in\n{cases}\nesac\n'
                              'exec ip netns exec "$host" unshare --uts sh -c "hostname $host; $*"\n')
        self.agent.chmod(0o755)

    def edit(self, side):
        mesh = Mesh()
        mesh.add_sheet(side, side)
        mesh.write(self.path)
        return write_edit(self.folder / "edit.json", self.path, **STEP)

    def start(self, edit):
        """Starts a rank on each host, from the first one. A connection that is dead is found within seconds."""
        environment = os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMP_NUM_THREADS": "1"}
        first = self.network.hosts[0]
        short = [part for name, value in (("time", 2), ("intvl", 1), ("probes", 2))
                 for part in ("--mca", f"oob_tcp_keepalive_{name}", str(value))]
        host = ["ip", "netns", "exec", first, "unshare", "--uts", "sh", "-c", f'hostname {first}; exec "$@"', "sh"]
        mpirun = [MPIRUN, "-n", "3", "--host", ",".join(self.network.addresses), "--mca", "plm_rsh_agent", str(self.agent),
                  "--mca", "btl", "tcp,self", "--mca", "mpi_yield_when_idle", "1", *short]
        process = subprocess.Popen([*host, *mpirun, MPI_PROGRAM, "deform", str(edit), "-o", str(self.output), "--tolerance", "1e-13"],
                                   stdout=self.log, stderr=subprocess.STDOUT, env=environment)
        self.addCleanup(process.kill)
        return process

    def ranks(self):
        """Returns the processes of this test's edit that run on the hosts."""
        found = []
        for process in Path("/proc").iterdir():
            try:
                words = (process / "cmdline").read_bytes().split(b"\0") if process.name.isdigit() else []
            except OSError:
                continue
            if words and words[0].decode() == MPI_PROGRAM and str(self.output).encode() in words:
                found.append(int(process.name))
        return found

    def wait_for_ranks(self, count, seconds):
        deadline = time.monotonic() + seconds
        while len(self.ranks()) != count and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertEqual(len(self.ranks()), count)

    def test_three_hosts_give_the_same_answer(self):
        edit = self.edit(40)
        process = self.start(edit)
        process.wait(300)
        self.assertEqual(process.returncode, 0, (self.folder / "log").read_text())
        across = read_ply(self.output)
        self.assertEqual(run_ranks(1, edit, "-o", self.output, "--tolerance", "1e-13").returncode, 0)
        self.assertLess(largest_difference(read_ply(self.output)[3], across[3]), 1e-9)

    def test_a_host_that_is_cut_off(self):
        process = self.start(self.edit(250))
        self.wait_for_ranks(3, 60)
        self.network.cut_off(2)
        process.wait(60)
        self.assertNotEqual(process.returncode, 0)
        self.wait_for_ranks(0, 30)
        self.assertFalse(self.output.exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
