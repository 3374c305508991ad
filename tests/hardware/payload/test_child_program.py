"""The owner's programs, as real processes: output, time limit, process group, and the camera's files."""

import logging
import os
import shutil
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from patience import MOMENT_S

from companion.config.payload import CameraSetting
from companion.hal.payload.child_program import CaptureProgram, ChildProgram

pytestmark = pytest.mark.slow


def python(code: str) -> list[str]:
    return [sys.executable, "-c", code]


def end_of(program: ChildProgram) -> str:
    give_up_s = time.monotonic() + MOMENT_S
    while (end := program.poll()) is None:
        assert time.monotonic() < give_up_s
        time.sleep(0.01)
    return end


def is_alive(pid: int) -> bool:
    """Whether a process runs; a zombie that nobody has reaped does not."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"


def wait_for(path: Path) -> str:
    give_up_s = time.monotonic() + MOMENT_S
    while not path.exists() or not path.read_text():
        assert time.monotonic() < give_up_s
        time.sleep(0.01)
    return path.read_text()


def test_output_goes_to_the_log_line_by_line_and_printable(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    program = ChildProgram("command 7", python("print('a\\x1b[31m'); print('b', end='')"), MOMENT_S)
    assert program.poll() is None
    program.start()
    assert end_of(program) == ""
    assert program.poll() is None
    lines = [one.getMessage() for one in caplog.records]
    assert lines == ["command 7: a [31m", "command 7: b"]


def test_a_flood_of_output_is_cut_and_does_not_hold_the_program(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    program = ChildProgram("command 7", python("print('x' * 5000); print('y\\n' * 100000)"), MOMENT_S)
    program.start()
    assert end_of(program) == ""
    assert len(caplog.records) == 201
    assert max(len(one.getMessage()) for one in caplog.records) < 520


@pytest.mark.parametrize(
    ("run", "end"),
    [
        (python("raise SystemExit(3)"), "exit code 3"),
        (python("import os; os.kill(os.getpid(), 11)"), "ended by signal SIGSEGV"),
        (["/no/such/program"], "cannot be started: No such file or directory"),
    ],
)
def test_a_program_that_fails_says_how(run: list[str], end: str) -> None:
    program = ChildProgram("command 7", run, MOMENT_S)
    program.start()
    assert end_of(program) == end


def test_there_is_no_shell_and_no_inherited_standard_input(tmp_path: Path) -> None:
    script = tmp_path / "show"
    script.write_text(
        f"#!{sys.executable}\nimport sys, os\nopen('out', 'w').write(repr((sys.argv[1:], sys.stdin.read(), "
        "os.environ.get('NOTIFY_SOCKET'), os.getsid(0) == os.getpid())))\n"
    )
    script.chmod(0o755)
    os.environ["NOTIFY_SOCKET"] = "/run/none"
    try:
        program = ChildProgram("command 7", [str(script), "$HOME; id", "*"], MOMENT_S, str(tmp_path))
        program.start()
        assert end_of(program) == ""
    finally:
        del os.environ["NOTIFY_SOCKET"]
    assert (tmp_path / "out").read_text() == repr((["$HOME; id", "*"], "", None, True))


SPAWN = """
import subprocess, sys, signal, time
signal.signal(signal.SIGTERM, signal.SIG_IGN)
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1000)"])
open(sys.argv[1], "w").write(str(child.pid))
time.sleep(1000)
"""


@pytest.mark.parametrize("way", ["time limit", "close"])
def test_the_whole_group_ends_with_the_program(tmp_path: Path, way: str) -> None:
    note = tmp_path / "pid"
    run = [*python(SPAWN), str(note)]
    program = ChildProgram("command 7", run, 1.0 if way == "time limit" else MOMENT_S)
    program.start()
    pid = int(wait_for(note))
    if way == "close":
        program.close()
        program.close()
    else:
        assert end_of(program) == "not done within 1 s"
    give_up_s = time.monotonic() + MOMENT_S
    while is_alive(pid):
        assert time.monotonic() < give_up_s
        time.sleep(0.01)
    assert not [one for one in threading.enumerate() if one.name == "command 7" and way != "close"]


def test_images_are_numbered_on_from_those_in_the_folder(tmp_path: Path) -> None:
    folder = tmp_path / "images"
    folder.mkdir()
    (folder / "image-00041.jpg").write_bytes(b"")
    (folder / "image-x.jpg").write_bytes(b"")
    code = "import sys; open(sys.argv[1], 'w').write('jpeg')"
    camera = CaptureProgram(CameraSetting(capture=(*python(code), "{file}"), folder=str(folder)))
    path = camera.start()
    assert path == str(folder / "image-00042.jpg")
    assert end_of(camera) == ""
    assert Path(path).read_text() == "jpeg"
    size_mb, free_mb = camera.space_mb()
    assert size_mb >= free_mb > 0.0


def test_a_medium_that_hangs_does_not_stop_who_asks_for_its_space(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked_by: list[int] = []

    def disk_usage(_: object) -> object:
        asked_by.append(threading.get_ident())
        return SimpleNamespace(total=4e9, free=3e9 - 1e9 * len(asked_by))

    monkeypatch.setattr(shutil, "disk_usage", disk_usage)
    code = "import sys; open(sys.argv[1], 'w').write('jpeg')"
    camera = CaptureProgram(CameraSetting(capture=(*python(code), "{file}"), folder=str(tmp_path)))
    assert camera.space_mb() == camera.space_mb() == (4000.0, 2000.0)
    assert len(asked_by) == 1, "at the start only"
    camera.start()
    assert end_of(camera) == ""
    assert camera.space_mb() == (4000.0, 1000.0)
    assert asked_by[1] != threading.get_ident(), "the program's thread may wait"
