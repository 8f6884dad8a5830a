"""meshgraft.edit: the editor on a mesh of this process. A scripted page stands for the browser."""

import gc
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import types
import webbrowser
from pathlib import Path

import numpy as np
import pytest

import meshgraft as mg
from meshgraft import _notebook

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/editor"))
from engine_client import Gone, Page  # noqa: E402


@pytest.fixture(autouse=True)
def with_editor(program):
    if "--result" not in subprocess.run([program, "edit", "--help"], capture_output=True, text=True).stdout:
        pytest.skip("the program has no editor")


def open_page(url):
    """Opens the page, and in it what the program was started with."""
    page = Page(url)
    welcome = page.event("welcome")
    assert welcome["waited_for"] is True
    page.ask({"do": "open", "path": welcome["models"][0]})
    return page


def pull(page, vertices, along=0.5, name="top"):
    page.ask({"do": "handle", "what": "add", "name": name, "select": {"indices": [int(v) for v in vertices]}, "reach": 2.0})
    page.ask({"do": "pose", "poses": {name: {"translate": [along, 0, 0]}}})


def finish(page):
    page.ask({"do": "done"})
    page.close()


def test_what_is_done_comes_back_and_runs_again_to_the_byte(bar, ends):
    editing = mg.edit(bar, show="none")
    assert editing.state == "open" and editing.edit_so_far.steps == ()
    page = open_page(editing.url)
    pull(page, ends["top"])
    assert editing.state == "open" and len(editing.edit_so_far.steps) == 1
    page.ask({"do": "accept"})
    pull(page, ends["bottom"], -0.25, "bottom")
    finish(page)
    moved = editing.mesh.vertices - bar.vertices
    assert editing.state == "done" and np.abs(moved).max() == 0.5
    assert (moved[ends["top"]][:, 0] == 0.5).all() and (moved[ends["bottom"]][:, 0] == -0.25).all()
    assert editing.edit.run().mesh.vertices.tobytes() == editing.mesh.vertices.tobytes()
    assert [step["kind"] for step in editing.edit.steps] == ["deform", "deform"]


def test_what_comes_back_has_the_type_that_went_in(bar, ends):
    trimesh = pytest.importorskip("trimesh")
    for given in ((bar.vertices, bar.faces), trimesh.Trimesh(bar.vertices, bar.faces, process=False)):
        editing = mg.edit(given, show="none")
        page = open_page(editing.url)
        pull(page, ends["top"])
        finish(page)
        moved = editing.mesh
        assert type(moved) is type(given) or isinstance(moved, np.ndarray)
        vertices = moved if isinstance(moved, np.ndarray) else moved.vertices
        assert np.asarray(vertices).tobytes() == editing.edit.run().mesh.vertices.tobytes()


def test_an_edit_goes_on(bar, ends, tmp_path):
    begun = mg.Edit().input("limb", bar).deform("limb", handles=ends, poses={"top": mg.Pose((0, 0.5, 0))})
    editing = mg.edit(edit=begun, show="none")
    page = open_page(editing.url)
    page.ask({"do": "pose", "poses": {"top": {"translate": [0, 1, 0]}}})
    finish(page)
    assert editing.mesh.vertices[ends["top"][0]][1] - bar.vertices[ends["top"][0]][1] == pytest.approx(1)
    wanted = mg.deform(bar, handles=ends, poses={"top": mg.Pose((0, 1, 0))})
    assert editing.mesh.vertices.tobytes() == wanted.vertices.tobytes()
    files = editing.edit.save(tmp_path / "kept.json")
    assert [file.name for file in files] == ["kept.json", "limb.ply"]
    assert mg.Edit.load(files[0]).run().mesh.vertices.tobytes() == wanted.vertices.tobytes()


def test_a_file_stays_a_file_and_gets_nothing_beside_it(bar, ends, tmp_path):
    mg.write(bar, tmp_path / "limb.ply")
    editing = mg.edit(tmp_path / "limb.ply", show="none")
    page = open_page(editing.url)
    pull(page, ends["top"])
    finish(page)
    assert editing.edit.run().mesh.vertices.tobytes() == editing.mesh.vertices.tobytes()
    assert editing.edit._json["inputs"] == {"limb": {"file": str(tmp_path / "limb.ply")}}
    assert os.listdir(tmp_path) == ["limb.ply"]


def test_an_edit_goes_on_with_files_that_it_names(bar, ends, tmp_path):
    (tmp_path / "a").mkdir()
    mg.write(bar, tmp_path / "a/limb.ply")
    (tmp_path / "a/top.txt").write_text("\n".join(map(str, ends["top"])))
    begun = mg.Edit().input("limb", "limb.ply")
    begun.deform("limb", handles=ends, poses={"top": mg.Pose((0, 0.5, 0))})
    next(handle for handle in begun._json["steps"][0]["handles"] if handle["name"] == "top")["select"] = {"file": "top.txt"}
    begun._folder = str(tmp_path / "a")
    wanted = begun.run().mesh.vertices.tobytes()
    (tmp_path / "b").mkdir()
    begun.save(tmp_path / "b/kept.json")
    loaded = mg.Edit.load(tmp_path / "b/kept.json")
    assert loaded.run().mesh.vertices.tobytes() == wanted
    editing = mg.edit(edit=loaded, show="none")
    page = open_page(editing.url)
    page.ask({"do": "pose", "poses": {"top": {"translate": [0, 1, 0]}}})
    finish(page)
    assert editing.mesh.vertices[ends["top"][0]][1] - bar.vertices[ends["top"][0]][1] == pytest.approx(1)
    assert editing.edit.run().mesh.vertices.tobytes() == editing.mesh.vertices.tobytes()


def test_parts_are_grafted(program):
    bust, head = mg.sample("bust", 24), mg.sample("head", 20)
    editing = mg.edit(bust, parts={"face": head}, show="none")
    page = open_page(editing.url)
    page.ask({"do": "graft", "source": "face", "target": "mesh",
              "matches": [[[0, -0.3, -0.4], [0, -0.3, -0.28]]]})
    page.ask({"do": "accept"})
    finish(page)
    assert len(editing.mesh) > len(bust) and editing.mesh.topology().manifold
    assert editing.edit.run().mesh.vertices.tobytes() == editing.mesh.vertices.tobytes()


def test_a_page_that_is_closed_ends_it_with_all_that_was_done(bar, ends):
    editing = mg.edit(bar, show="none")
    page = open_page(editing.url)
    pull(page, ends["top"])
    page.close()
    assert editing.wait().state == "closed"
    assert np.abs(editing.mesh.vertices - bar.vertices).max() == 0.5


def test_nothing_done_is_the_mesh_that_was_given(bar):
    with mg.edit(bar, show="none") as editing:
        finish(open_page(editing.url))
        editing.wait()
    assert editing.state == "done" and editing.mesh is bar and editing.edit.steps == ()
    with mg.edit(bar, show="none") as editing:
        folder = editing._folder
        assert folder.exists()
    assert editing.state == "interrupted" and editing.mesh is bar and not folder.exists()


def test_a_graft_that_is_not_complete_is_left_out(ends, bar):
    editing = mg.edit(bar, parts={"ring": mg.sample("bar", 8)}, show="none")  # neither has a boundary loop
    page = open_page(editing.url)
    pull(page, ends["top"])
    page.ask({"do": "accept"})
    page.ask({"do": "graft", "source": "ring", "target": "mesh"})
    assert page.refusal({"do": "done"})["id"]  # told in the page, and the editor goes on
    editing.close()
    assert [step["kind"] for step in editing.edit.steps] == ["deform"] and "left out" in editing.note
    assert np.abs(editing.mesh.vertices - bar.vertices).max() == 0.5


@pytest.mark.parametrize("when", ["while the browser opens", "while it waits"])
def test_ctrl_c_ends_it_and_keeps_what_was_done(bar, ends, monkeypatch, capsys, when):
    pages = []
    wait = mg.Editing.wait

    def interrupt():
        threading.Thread(target=os.kill, args=(os.getpid(), signal.SIGINT)).start()

    def interrupted_wait(editing):
        interrupt()
        return wait(editing)

    def browse(address):
        url = Path(address.removeprefix("file://")).read_text().split('href="')[1].split('"')[0]
        pages.append(open_page(url))
        pull(pages[0], ends["top"])
        if when == "while the browser opens":
            interrupt()
        return True

    monkeypatch.setattr(webbrowser, "open", browse)
    if when == "while it waits":
        monkeypatch.setattr(mg.Editing, "wait", interrupted_wait)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
    try:
        editing = mg.edit(bar)
    finally:
        signal.signal(signal.SIGINT, before)
        monkeypatch.undo()
    assert editing.state == "interrupted" and np.abs(editing.mesh.vertices - bar.vertices).max() == 0.5
    assert editing.url in capsys.readouterr().err
    with pytest.raises(Gone):
        pages[0].ask({"do": "state"})


def test_waiting_has_a_limit(bar):
    with mg.edit(bar, show="none") as editing, pytest.raises(TimeoutError):
        editing.wait(0.01)


KILLED = textwrap.dedent("""
    import os, signal
    import meshgraft as mg
    editing = mg.edit(mg.sample("bar", 8), show="none")
    print(editing._process.pid, editing._folder, flush=True)
    os.kill(os.getpid(), signal.SIGKILL)
""")


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="no /proc")
def test_a_process_that_is_killed_leaves_no_editor_behind():
    said = subprocess.run([sys.executable, "-c", KILLED], capture_output=True, text=True).stdout.split()
    while runs(said[0]):
        time.sleep(0.01)


def runs(process):
    """Returns whether a process runs; one that has ended and that nobody has asked for does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.filterwarnings("ignore:subprocess .* is still running:ResourceWarning")
def test_an_editor_that_nobody_waits_for_any_more_ends(bar):
    editing = mg.edit(bar, show="none")
    process, folder = editing._process.pid, editing._folder
    del editing
    gc.collect()
    assert not folder.exists()
    while runs(process):
        time.sleep(0.01)


def test_a_program_that_cannot_start_is_told_of(bar):
    with pytest.raises(RuntimeError, match="origin"):
        mg.edit(bar, show="none", origin="http://localhost:8888/lab")
    with pytest.raises(TypeError):
        mg.edit()
    with pytest.raises(ValueError, match="notebook"):
        mg.edit(bar, show="cell")


@pytest.fixture
def in_a_notebook(monkeypatch, tmp_path):
    """As if a kernel of a server on this machine ran this."""
    shown = []
    shell = types.SimpleNamespace(kernel=object())
    display = types.SimpleNamespace(HTML=lambda text: text, display=shown.append)
    monkeypatch.setitem(sys.modules, "IPython", types.SimpleNamespace(get_ipython=lambda: shell, display=display))
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    monkeypatch.setattr(_notebook, "_server", lambda: {"url": "http://localhost:8888/", "base_url": "/", "secure": False})
    return shown


def test_in_a_notebook_it_is_in_the_cell_and_waits_for_nothing(bar, ends, in_a_notebook):
    editing = mg.edit(bar, proxy=False)
    assert editing.state == "open" and f'src="{editing.url}"' in in_a_notebook[0].replace("&amp;", "&")
    import urllib.request

    with urllib.request.urlopen(editing.url) as answer:
        policy = answer.headers["Content-Security-Policy"]
    assert policy.endswith("frame-ancestors http://localhost:8888 http://127.0.0.1:8888")
    page = open_page(editing.url)
    pull(page, ends["top"])
    finish(page)
    assert np.abs(editing.mesh.vertices - bar.vertices).max() == 0.5

    with mg.edit(bar, proxy=True) as editing:
        port, query = editing.url.split(":")[2].split("/?")
        assert f'src="/proxy/{port}/?{query}"' in in_a_notebook[1]


def test_an_edit_that_cannot_run_is_kept(bar, ends, tmp_path):
    file, aside = tmp_path / "limb.ply", tmp_path / "aside.ply"
    mg.write(bar, file)
    editing = mg.edit(file, show="none")
    page = open_page(editing.url)
    pull(page, ends["top"])
    finish(page)
    editing.wait()
    file.rename(aside)
    with pytest.raises(mg.FileError):
        editing.mesh
    assert len(editing.edit.steps) == 1 and editing.note == ""
    aside.rename(file)
    assert np.abs(editing.mesh.vertices - bar.vertices).max() == 0.5


def test_several_threads_may_wait(bar, ends):
    editing = mg.edit(bar, show="none")
    found = []
    threads = [threading.Thread(target=lambda: found.append(editing.mesh)) for _ in range(4)]
    for thread in threads:
        thread.start()
    page = open_page(editing.url)
    pull(page, ends["top"])
    finish(page)
    for thread in threads:
        thread.join()
    assert len(found) == 4 and all(mesh is found[0] for mesh in found)


def test_a_fork_leaves_the_editor_alone(bar, ends):
    editing = mg.edit(bar, show="none")
    child = os.fork()
    if child == 0:
        try:
            with pytest.raises(RuntimeError, match="forked"):
                editing.close()
            editing._clean_up()
            os._exit(0 if editing.state == "open" else 1)
        finally:
            os._exit(2)
    assert os.waitpid(child, 0)[1] == 0
    page = open_page(editing.url)
    pull(page, ends["top"])
    finish(page)
    assert np.abs(editing.mesh.vertices - bar.vertices).max() == 0.5


def test_parts_have_names_of_their_own(bar):
    with pytest.raises(ValueError, match="parts: 'mesh'"):
        mg.edit(bar, parts={"mesh": bar}, show="none")
    with pytest.raises(ValueError, match="name: '../evil'"):
        mg.edit(bar, name="../evil", show="none")
    with pytest.raises(ValueError, match="show"):
        mg.edit(bar, show="window")
