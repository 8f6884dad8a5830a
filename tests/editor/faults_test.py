#!/usr/bin/env python3
"""Checks that the editor's work survives when the program, the disk or the page fails.

    faults_test.py MESHGRAFT [SEED]

Starts `meshgraft edit` as a process, again and again. Takes less than a minute.
"""

import json
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from engine_client import Engine, Gone

program = str(Path(sys.argv[1]).resolve())
seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
chance = random.Random(seed)
kills = 50


def run(*arguments):
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)


def make_model(path, resolution=16):
    made = run("sample", "bar", "--resolution", resolution, "-o", path)
    assert made.returncode == 0, made.stderr


def paint_top(page):
    page.ask({"do": "handle", "what": "add", "name": "top", "reach": 2,
              "select": {"half_space": {"point": [0, 0, 3.7], "normal": [0, 0, 1]}}})


def lift(height):
    return {"do": "pose", "poses": {"top": {"translate": [0, 0, height]}}}


def save_in(folder):
    return {"do": "save", "edit": str(folder / "work.json"), "mesh": str(folder / "work.ply"), "overwrite": True}


def height_of(page):
    handles = page.ask({"do": "state"})["handles"]
    return handles[0]["pose"].get("translate", [0, 0, 0])[2] if handles else None


def work_until_killed(engine, page, folder, counter):
    """Raises the top, drags and saves until a kill. Returns the last acknowledged and the last sent number."""
    acknowledged = sent = counter
    end = time.monotonic() + chance.uniform(0.01, 0.25)
    waiting = []
    try:
        while time.monotonic() < end:
            sent += 1
            waiting.append((sent, page.send(lift(sent))))
            for _ in range(chance.randrange(3)):
                page.send({"do": "drag", "poses": {"top": {"translate": [chance.random(), 0, 0]}}})
            if chance.random() < 0.1:
                page.send(save_in(folder))
            if chance.random() < 0.7:
                acknowledged, number = waiting[-1]
                page.reply_to(number)
        if chance.random() < 0.2:  # a kill after which the model's journal has nothing to restore
            page.ask(save_in(folder))
            acknowledged = sent
    except Gone:
        pass
    engine.kill()
    page.close()
    return acknowledged, sent


def restore(page):
    """Restores the work that an earlier process left in the journal. Returns whether there was any."""
    reply = page.reply_to(page.send({"do": "restore"}))
    if "error" in reply:
        assert reply["error"]["id"] == "editor.nothing_to_restore", reply
        return False
    if page.ask({"do": "state"})["undo"] == "remove_step":  # killed while it set up the step
        page.ask({"do": "undo"})
    return True


def check_files(folder):
    """Checks that files that were being written are whole, or as they were before."""
    if (folder / "work.json").exists():
        json.loads((folder / "work.json").read_text())
    if (folder / "work.ply").exists():
        whole = run("info", folder / "work.ply", "--json")
        assert whole.returncode == 0, whole.stderr


def kills_lose_nothing_that_was_acknowledged(folder):
    make_model(folder / "bar.ply")
    acknowledged, sent, offered = 0, 0, 0
    for number in range(kills):
        with Engine(program, folder / "bar.ply") as engine:
            page = engine.page()
            page.ask({"do": "open", "path": str(folder / "bar.ply")})
            if number > 0:
                restored = restore(page)
                if not restored and (folder / "work.json").exists():  # all of the model's journal was saved
                    page.ask({"do": "open", "path": str(folder / "work.json")})
                    restored = restore(page)
                offered += restored
            height = height_of(page)
            if height is None:
                assert acknowledged == 0, f"kill {number}: {acknowledged} is lost"
                paint_top(page)
            else:
                assert acknowledged <= height <= sent, f"kill {number}: {height}, not {acknowledged} to {sent}"
            acknowledged, sent = work_until_killed(engine, page, folder, max(sent, int(height or 0)))
        if number % 10 == 9:
            check_files(folder)
    assert offered > kills // 2, offered
    return f"{kills} kills, {sent} changes, {offered} restored"


def a_full_disk_is_told_and_leaves_the_earlier_file(folder):
    make_model(folder / "bar.ply")
    size = (folder / "bar.ply").stat().st_size
    (folder / "out.ply").write_bytes(b"the earlier file")

    def little_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (size // 2, size // 2))

    with Engine(program, folder / "bar.ply", limits=little_room) as engine:
        page = engine.page()
        page.ask({"do": "open", "path": str(folder / "bar.ply")})
        paint_top(page)
        page.ask(lift(1))
        error = page.refusal({"do": "save", "mesh": str(folder / "out.ply"), "overwrite": True})
        assert error["code"] == "io" and "out.ply" in error["location"], error
        assert (folder / "out.ply").read_bytes() == b"the earlier file"
        assert page.ask({"do": "state"})["dirty"], "nothing was saved"
        assert height_of(page) == 1, "the work goes on"
        page.ask({"do": "save", "edit": str(folder / "out.json")})
        engine.end(signal.SIGTERM)
    assert run("run", folder / "out.json", "-o", folder / "out.ply").returncode == 0
    left = sorted(path.name for path in folder.iterdir())
    assert left == ["bar.ply", "out.json", "out.ply"], left
    return "the earlier file is there"


def a_full_disk_for_the_journal_is_told_and_work_goes_on(folder):
    make_model(folder / "bar.ply")

    def no_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500))

    with Engine(program, folder / "bar.ply", limits=no_room) as engine:
        page = engine.page()
        page.ask({"do": "open", "path": str(folder / "bar.ply")})
        paint_top(page)
        notice = page.event("notice")["error"]
        assert notice["code"] == "io" and "meshgraft-session" in notice["location"], notice
        page.ask(lift(1))
        assert height_of(page) == 1
    return "told"


def a_replaced_model_is_noted(folder):
    make_model(folder / "bar.ply")
    with Engine(program, folder / "bar.ply") as engine:
        page = engine.page()
        page.ask({"do": "open", "path": str(folder / "bar.ply")})
        paint_top(page)
        page.ask(lift(1))
        earlier = page.ask({"do": "save", "edit": str(folder / "bar.json"), "mesh": str(folder / "one.ply")})
        assert earlier["notes"] == [], earlier
        kept = (folder / "bar.ply").read_bytes()
        make_model(folder / "bar.ply", 12)
        saved = page.ask({"do": "save", "edit": str(folder / "bar.json"), "mesh": str(folder / "two.ply")})
        assert any(note["id"] == "editor.input_replaced" for note in saved["notes"]), saved
        assert (folder / "one.ply").read_bytes() == (folder / "two.ply").read_bytes(), "the edit of what was opened"
        (folder / "bar.ply").unlink()
        gone = page.ask({"do": "export", "path": str(folder / "three.ply")})
        assert any(note["id"] == "editor.input_gone" for note in gone["notes"]), gone
    make_model(folder / "bar.ply", 12)
    refused = run("run", folder / "bar.json", "-o", folder / "four.ply")
    assert refused.returncode == 3 and "SHA-256" in refused.stderr, refused.stderr
    (folder / "bar.ply").write_bytes(kept)
    assert run("run", folder / "bar.json", "-o", folder / "four.ply").returncode == 0
    assert (folder / "four.ply").read_bytes() == (folder / "one.ply").read_bytes()
    return "noted"


def an_endless_upload_is_refused(folder):
    if shutil.disk_usage(folder).free < 3 << 30:
        return "skipped: less than 3 GB of disk"
    piece = bytes(4 << 20)
    with Engine(program, "--folder", folder, env={"TMPDIR": str(folder)}) as engine:
        status, text = engine.page().upload("huge.ply", (piece for _ in range(512)))
        assert status == 413 and "MB are not taken" in text, (status, text)
        left = [path for path in folder.glob("meshgraft-editor-*/uploads/*")]
        assert not left, left
        memory = engine.peak_memory()
        assert memory < 200 << 20, memory
        page = engine.page()
        page.ask({"do": "open", "sample": "bar"})
    return f"{memory >> 20} MB at most"


def signals_end_a_drag(folder):
    make_model(folder / "bar.ply", 60)
    seconds = []
    for ending in (signal.SIGTERM, signal.SIGINT):
        with Engine(program, folder / "bar.ply", env={"TMPDIR": str(folder)}) as engine:
            page = engine.page()
            page.ask({"do": "open", "path": str(folder / "bar.ply")})
            page.event("state")
            if ending == signal.SIGINT:
                page.ask({"do": "restore"})
            else:
                paint_top(page)
            page.ask(lift(1))
            for step in range(20):
                page.send({"do": "drag", "poses": {"top": {"translate": [0, 0.01 * step, 0]}}})
            start = time.monotonic()
            status = engine.end(ending)
            seconds.append(time.monotonic() - start)
            assert status == 0, status
            assert "error" not in engine.process.stderr.read()
        assert not list(folder.glob("meshgraft-*editor-*")), "its folder goes with the program"
    return f"{max(seconds):.1f} s at most"


def wait_until(holds, what, patience=60):
    end = time.monotonic() + patience
    while not holds():
        assert time.monotonic() < end, what
        time.sleep(0.001)


def a_step_that_ended_the_engine_is_not_run_again(folder):
    model = folder / "large.ply"
    running = folder / "large.ply.meshgraft-session.running"
    make_model(model, 120)

    def opened(engine):
        page = engine.page()
        page.ask({"do": "open", "path": str(model)})
        return page

    def mark():
        try:
            return running.read_bytes()
        except FileNotFoundError:
            return b""

    def kill_in_step(engine, left=b""):
        """Kills the engine while it runs a step. `left` is the mark of an engine that was killed before."""
        wait_until(lambda: mark() not in (b"", left), "no step runs")
        engine.kill()
        assert running.exists(), "the step ended before the kill"

    def restored(page, left_out):
        page.ask({"do": "restore"})
        notice = page.event("notice")["error"]
        assert notice["id"] == "editor.ended_in_step" and notice["fields"] == {"step": left_out}, notice
        return page.ask({"do": "state"})

    def settle(page):
        page.event("live", lambda event: event.get("stage") == "ready")
        wait_until(lambda: not running.exists(), "the mark stays after the end of the step")

    with Engine(program, model) as engine:  # the set-up of the first step
        page = opened(engine)  # its connection stays open: the engine ends a session that no page holds
        paint_top(page)
        kill_in_step(engine)
    with Engine(program, model) as engine:
        page = opened(engine)
        state = restored(page, 1)
        assert not state["handles"] and state["undo"] == "remove_step", state
        assert not running.exists()
        page.ask({"do": "undo"})
        assert len(page.ask({"do": "state"})["handles"]) == 1, "undo brings the step back"
        settle(page)
        page.ask(lift(1))
        page.ask({"do": "accept"})
        paint_top(page)  # the set-up of the second step
        kill_in_step(engine)
    with Engine(program, model) as engine:
        page = opened(engine)
        left = mark()
        page.send({"do": "restore"})  # runs the first step
        kill_in_step(engine, left)
    with Engine(program, model) as engine:
        page = opened(engine)
        state = restored(page, 1)
        assert len(state["steps"]) == 1 and not state["handles"], state
        page.ask({"do": "undo"})
        settle(page)
        state = page.ask({"do": "state"})
        assert len(state["steps"]) == 2 and len(state["handles"]) == 1, "undo brings both back"
        page.close()
        assert engine.end(signal.SIGTERM) == 0
    assert not running.exists(), "an end in order leaves no mark"
    with Engine(program, model) as engine:
        page = opened(engine)
        page.ask({"do": "restore"})
        assert len(page.ask({"do": "state"})["steps"]) == 2, "no step ended the engine"
    return "left out, and undone"


def folders_of_killed_engines_are_removed(folder):
    def start():
        return Engine(program, "--folder", folder, env={"TMPDIR": str(folder)})

    def kept():
        return len(list(folder.glob("meshgraft-*editor-*")))

    with start() as engine:
        engine.kill()
    assert kept() == 1, "nobody was there to remove it"
    with start() as first, start() as second:
        assert kept() == 2, "the next engine removes it, and leaves those of running ones"
        first.end(signal.SIGTERM)
        second.end(signal.SIGTERM)
    assert kept() == 0
    return "removed"


def main():
    failed = 0
    for test in (kills_lose_nothing_that_was_acknowledged, a_full_disk_is_told_and_leaves_the_earlier_file,
                 a_full_disk_for_the_journal_is_told_and_work_goes_on, a_replaced_model_is_noted,
                 an_endless_upload_is_refused, signals_end_a_drag, a_step_that_ended_the_engine_is_not_run_again,
                 folders_of_killed_engines_are_removed):
        start = time.monotonic()
        with tempfile.TemporaryDirectory(prefix="meshgraft-faults-") as folder:
            try:
                outcome = test(Path(folder))
            except (AssertionError, Gone, RuntimeError, OSError, subprocess.TimeoutExpired) as error:
                failed += 1
                outcome = f"FAILED (seed {seed}): {type(error).__name__}: {error}"
        print(f"{test.__name__}: {outcome} ({time.monotonic() - start:.1f} s)")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
