"""The GIL, progress, interruption, forks and memory."""

import gc
import multiprocessing
import os
import subprocess
import sys
import textwrap
import threading
import time
import weakref
from pathlib import Path

import numpy as np
import pytest

import meshgraft as mg
from conftest import bend


def test_two_solves_run_while_a_third_thread_counts(bar):
    fine = mg.sample("bar", 60)
    z = fine.vertices[:, 2]
    ends = {"bottom": z < 0.3, "top": z > 3.7}
    started, done, count = threading.Barrier(3), threading.Event(), 0
    results = []

    def solve():
        started.wait()
        results.append(mg.Deformer(fine, handles=ends, threads=1).positions(top=bend()))
        if len(results) == 2:
            done.set()

    solvers = [threading.Thread(target=solve) for _ in range(2)]
    for thread in solvers:
        thread.start()
    started.wait()
    while not done.is_set():
        count += 1
        time.sleep(0.001)
    for thread in solvers:
        thread.join()
    assert results[0].tobytes() == results[1].tobytes()
    assert count > 20


def test_one_deformer_serves_several_threads(bar, ends):
    d = mg.Deformer(bar, handles=ends)
    wanted = [d.positions(top=bend(10 * k)).tobytes() for k in range(4)]
    found = [None] * 4

    def evaluate(k):
        found[k] = d.positions(top=bend(10 * k)).tobytes()

    threads = [threading.Thread(target=evaluate, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == wanted


def test_progress_is_delivered_on_the_calling_thread(bar, ends):
    heard = []

    def listen(stage, fraction):
        heard.append((stage, threading.get_ident()))
        assert fraction is None or 0 <= fraction <= 1

    mg.deform(bar, handles=ends, poses={"top": bend()}, progress=listen)
    stages = [stage for stage, _ in heard]
    assert "solve" in stages and {thread for _, thread in heard} == {threading.get_ident()}


def test_an_exception_of_the_progress_function_ends_the_call(bar, ends):
    class Enough(Exception):
        pass

    def stop(*_):
        raise Enough

    with pytest.raises(Enough):
        mg.deform(mg.sample("bar", 60), handles={"top": mg.select.half_space((0, 0, 3), "z")}, progress=stop)
    assert mg.check(bar).findings == ()  # nothing is left behind


def test_a_bar_is_shown(bar, ends, capsys):
    pytest.importorskip("tqdm")
    mg.deform(bar, handles=ends, poses={"top": bend()}, progress=True)
    assert "%" in capsys.readouterr().err


INTERRUPTED = textwrap.dedent("""
    import os, signal, sys, time
    import meshgraft as mg
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
    mesh = mg.sample("bar", int(sys.argv[2]))
    z = mesh.vertices[:, 2]
    sent = []
    def interrupt():
        sent.append((time.monotonic(), time.process_time()))
        os.kill(os.getpid(), signal.SIGINT)
    def listen(stage, fraction):
        if stage == sys.argv[1] and not sent:
            interrupt()
    try:
        mg.Deformer(mesh, handles={"bottom": z < 0.3, "top": z > 3.7}, progress=listen)
        print("ended before the stage")
    except KeyboardInterrupt:
        print(time.monotonic() - sent[0][0], time.process_time() - sent[0][1])
    assert mg.sample("bar", 8).topology().closed
""")


@pytest.mark.parametrize("stage", ["assemble", "factorise"])
def test_an_interrupt_ends_a_set_up(stage):
    interrupted_at(stage, 120)


def interrupted_at(stage, resolution):
    """Interrupts a set-up, and returns the seconds until it ended, by the clock and of all processors."""
    result = subprocess.run([sys.executable, "-c", INTERRUPTED, stage, str(resolution)], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    return tuple(map(float, result.stdout.split()))  # no numbers where it was not interrupted


@pytest.mark.parametrize("stage", ["assemble", "factorise"])
def test_an_interrupt_ends_a_large_set_up_soon(stage):
    clock, processors = interrupted_at(stage, 500)  # 250,000 vertices
    print(f"{stage}: {1000 * clock:.0f} ms, {1000 * processors:.0f} ms of processor time")
    # The clock also counts what other programs do. All threads together take no more than each may.
    assert processors < 0.15 * len(os.sched_getaffinity(0))


def evaluate_in_child(queue, d):
    before = threading.active_count()
    positions = d.positions(top=bend())
    fresh = mg.Deformer(mg.sample("bar", 12), handles={"top": mg.select.half_space((0, 0, 3), "z")})
    queue.put((positions.tobytes(), len(os.listdir("/proc/self/task")), before, len(fresh.free_vertices)))


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_after_a_fork_one_thread_computes(bar, ends):
    d = mg.Deformer(bar, handles=ends)
    wanted = d.positions(top=bend()).tobytes()
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=evaluate_in_child, args=(queue, d))
    child.start()
    found, tasks, _, free = queue.get(timeout=120)
    child.join(timeout=60)
    assert child.exitcode == 0 and found == wanted and free > 0
    assert tasks <= 4  # the process itself, its parked thread, and the queue's


def drag_in_child(queue, live):
    try:
        live.drag(top=bend())
        queue.put("dragged")
    except RuntimeError as error:
        queue.put(str(error))


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_live_deformer_refuses_to_work_in_a_fork(bar, ends):
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    with mg.LiveDeformer(bar, handles=ends) as live:
        live.drag(top=bend())
        live.wait()
        child = context.Process(target=drag_in_child, args=(queue, live))
        child.start()
        assert "forked" in queue.get(timeout=120)
        child.join(timeout=60)
        assert child.exitcode == 0


def test_a_live_deformer_ends_with_the_exact_frame(bar, ends):
    frames, failures = [], []
    with mg.LiveDeformer(bar, handles=ends, on_frame=frames.append, on_failure=lambda *a: failures.append(a),
                         settle_seconds=0.01) as live:
        assert live.frame is None and live.mesh is bar
        for angle in (10, 20, 30):
            number = live.drag(top=bend(angle))
        live.wait()
        assert number == 3 and live.frame.pose == 3 and live.frame.accuracy == "exact" and live.superseded >= 0
        exact = mg.Deformer(bar, handles=ends).positions(top=bend(30))
        assert live.frame.vertices.tobytes() == exact.tobytes() == live.mesh.vertices.tobytes()
        assert live.stage in ("exact", "ready") and live.handles == ("bottom", "top")
    assert failures == [] and [frame.pose for frame in frames] == sorted(frame.pose for frame in frames)
    assert frames[-1].error_rel == 0 and frames[-1].seconds >= 0
    assert live.drag(top=bend()) == 0 and live.stage == "closed"
    with pytest.raises(mg.Cancelled):
        live.wait()


def test_a_live_deformer_tells_why_it_cannot_work(bar, ends):
    failures = []
    live = mg.LiveDeformer(bar, handles={"a": mg.Handle(ends["top"][:1], shape="vertex", constrain="position")},
                           on_failure=lambda pose, error: failures.append(error))
    with pytest.raises(mg.UnsolvableError):
        live.wait()
    while not failures:  # it is told on a thread of its own
        time.sleep(0.001)
    live.close()
    assert live.stage in ("failed", "closed") and failures[0].id.startswith("deform.")


def test_a_callback_of_a_live_deformer_cannot_wait(bar, ends):
    told = []

    def wait(frame):
        with pytest.raises(mg.UsageError) as error:
            live.wait()
        told.append(error.value.id)

    with mg.LiveDeformer(bar, handles=ends, on_frame=wait) as live:
        live.drag(top=bend())
        live.wait()
    assert told and set(told) == {"deform.wait_in_callback"}


def test_a_live_deformer_whose_function_knows_it_is_collected(bar, ends):
    frames = []
    live = mg.LiveDeformer(bar, handles=ends, on_frame=lambda frame: frames.append(live.stage))
    live.drag(top=bend())
    live.wait()
    gone = weakref.ref(live)
    del live
    gc.collect()
    assert gone() is None and frames


def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc")
def test_ten_thousand_evaluations_take_no_memory():
    bar = mg.sample("bar", 8)
    z = bar.vertices[:, 2]
    basis = mg.Deformer(bar, handles={"bottom": z < 0.3, "top": z > 3.7}, method="ft05").handle_basis(normals=False)
    for k in range(1000):
        basis.frame(top=bend(k))
    before = resident()
    for k in range(10_000):
        basis.frame(top=bend(k))
    assert resident() - before < 2 << 20


def test_an_evaluation_goes_into_the_callers_array(bar, ends):
    d = mg.Deformer(bar, handles=ends)
    out = np.full_like(bar.vertices, np.nan)
    address = out.ctypes.data
    assert d.positions(top=bend(), out=out) is out and out.ctypes.data == address
    assert out.tobytes() == d.positions(top=bend()).tobytes()
