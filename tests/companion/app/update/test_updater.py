"""An update of mavboat: done whole or taken back whole, whatever fails and wherever the power goes."""

import json
import os
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from wheels import contents, make_wheel

from companion.app.update.installation import Installation, UpdateError
from companion.app.update.journal import Result
from companion.app.update.spool import update_from_spool
from companion.app.update.system import copy_wheel, read_armed
from companion.app.update.updater import Updater

NOW_S = 1_800_000_000.0
STEPS = ["install", "compile", "check", "restart"]
OLD = {
    **contents("0.1.0", {"companion/gone.py": b"old = 1\n", "sitl/__init__.py": b""}),
    "mavboat-0.1.0.dist-info/RECORD": b"companion/__init__.py,,\n",
    "companion/_kernel.so": b"compiled from old sources",
}
NEW = {"companion/__init__.py": b"new = 1\n", "companion/more.py": b"more = 1\n"}
PROGRAM = "#!/usr/bin/python\nfrom companion.__main__ import main\n"


class PowerCutError(BaseException):
    """Everything stops."""


class FakeSystem:
    """pip and the services of a boat in a folder. fails: the step that raises; cuts: where the power goes."""

    def __init__(self, site: Path, fails: str = "", cuts: str = "") -> None:
        self.site = site
        self.fails = fails
        self.cuts = cuts
        self.armed = [False]
        self.did: list[str] = []

    def _do(self, step: str) -> None:
        self.did.append(step)
        if self.cuts == step:
            raise PowerCutError
        if self.fails == step and self.did.count(step) == 1:
            raise UpdateError(f"{step} failed")

    def is_armed(self) -> bool:
        return self.armed.pop(0) if len(self.armed) > 1 else self.armed[0]

    def install(self, wheel: Path) -> None:
        for name in OLD:
            if not name.endswith(".so"):
                (self.site / name).unlink(missing_ok=True)
        (self.site / "mavboat-0.1.0.dist-info").rmdir()
        self._do("install")  # half of it, if the power goes
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(self.site)

    def compile(self) -> None:
        self._do("compile")

    def check(self) -> None:
        self._do("check")

    def restart(self) -> None:
        self._do("restart")


class Boat:
    """A boat's environment and an updater of it."""

    def __init__(self, root: Path) -> None:
        self.site, self.programs, self.folder = root / "site", root / "bin", root / "state"
        for one in (self.site, self.programs, self.folder):
            one.mkdir()
        for name, content in OLD.items():
            (self.site / name).parent.mkdir(exist_ok=True)
            (self.site / name).write_bytes(content)
        (self.site / "msgspec").mkdir()
        (self.site / "msgspec" / "__init__.py").touch()
        (self.programs / "boat-companion").write_text(PROGRAM, encoding="ascii")
        (self.programs / "python").touch()
        self.waits: list[float] = []
        self.old = self.files()

    def updater(self, system: FakeSystem) -> Updater:
        installation = Installation(self.site, self.programs, self.folder / "kept")
        return Updater(self.folder, installation, system, lambda: NOW_S, self.waits.append)

    def update(self, system: FakeSystem, wheel: Path) -> Result:
        return self.updater(system).update(wheel.name, lambda goal: copy_wheel(wheel, goal, 1_000_000))

    def files(self) -> dict[str, bytes]:
        return {
            str(path.relative_to(top)): path.read_bytes()
            for top in (self.site, self.programs)
            for path in top.rglob("*")
            if path.is_file()
        }

    def is_new(self) -> bool:
        return (
            self.files()["companion/__init__.py"] == NEW["companion/__init__.py"]
            and "companion/gone.py" not in self.files()
            and "companion/_kernel.so" not in self.files()
            and "mavboat-0.2.0.dist-info/METADATA" in self.files()
        )

    def told(self) -> dict[str, object]:
        found: dict[str, object] = json.loads((self.folder / "result.json").read_bytes())
        return found

    def left(self) -> list[str]:
        return sorted(path.name for path in self.folder.iterdir() if path.name != "result.json")


@pytest.fixture
def boat(tmp_path: Path) -> Boat:
    root = tmp_path / "boat"
    root.mkdir()
    return Boat(root)


@pytest.fixture
def wheel(tmp_path: Path) -> Path:
    return make_wheel(tmp_path, files=NEW)


def test_an_update_ends_with_the_new_version_and_nothing_of_the_old(boat: Boat, wheel: Path) -> None:
    system = FakeSystem(boat.site)
    assert boat.update(system, wheel) == Result("done", "0.2.0", "0.1.0", "0.2.0 runs", NOW_S)
    assert system.did == STEPS
    assert boat.is_new()
    assert "msgspec/__init__.py" in boat.files()
    assert boat.told()["state"] == "done"
    assert boat.left() == []


@pytest.mark.parametrize("step", STEPS)
def test_whatever_fails_the_old_version_is_back_and_runs(boat: Boat, wheel: Path, step: str) -> None:
    system = FakeSystem(boat.site, fails=step)
    result = boat.update(system, wheel)
    assert (result.state, result.text) == ("went back", f"Went back to 0.1.0: {step} failed")
    assert boat.files() == boat.old
    assert system.did[-1] == "restart"
    assert boat.left() == []


@pytest.mark.parametrize("step", STEPS)
def test_a_power_cut_in_any_step_leaves_the_old_version_or_the_new_one(
    boat: Boat, wheel: Path, step: str
) -> None:
    with pytest.raises(PowerCutError):
        boat.update(FakeSystem(boat.site, cuts=step), wheel)
    assert boat.told()["state"] == "running"
    again = FakeSystem(boat.site)
    result = boat.updater(again).recover()
    assert result is not None
    if step == "restart":
        assert (result.state, boat.is_new()) == ("done", True)
    else:
        assert (result.state, boat.files()) == ("went back", boat.old)
    assert again.did[-1] == "restart"
    assert boat.left() == []
    assert boat.updater(again).recover() is None


def test_a_second_power_cut_while_going_back_is_survived(boat: Boat, wheel: Path) -> None:
    with pytest.raises(PowerCutError):
        boat.update(FakeSystem(boat.site, cuts="check"), wheel)
    with pytest.raises(PowerCutError):
        boat.updater(FakeSystem(boat.site, cuts="restart")).recover()
    result = boat.updater(FakeSystem(boat.site)).recover()
    assert result is not None
    assert (result.state, boat.files()) == ("went back", boat.old)


def test_an_interrupted_update_waits_for_an_armed_boat(boat: Boat, wheel: Path) -> None:
    with pytest.raises(PowerCutError):
        boat.update(FakeSystem(boat.site, cuts="check"), wheel)
    system = FakeSystem(boat.site)
    system.armed = [True, True, False]
    result = boat.updater(system).recover()
    assert result is not None
    assert (result.state, len(boat.waits)) == ("went back", 2)


def test_an_armed_boat_is_not_updated(boat: Boat, wheel: Path) -> None:
    for armed in ([True], [False, True]):  # from the beginning; armed while the files were kept
        system = FakeSystem(boat.site)
        system.armed = armed
        result = boat.update(system, wheel)
        assert (result.state, result.text) == ("refused", "The boat is armed, or may be: disarm it first")
        assert system.did == []
        assert boat.files() == boat.old
        assert boat.left() == []


def test_a_boat_that_was_armed_meanwhile_keeps_the_old_version_and_runs_on(boat: Boat, wheel: Path) -> None:
    system = FakeSystem(boat.site)
    system.armed = [False, False, True]
    assert boat.update(system, wheel).state == "went back"
    assert boat.files() == boat.old
    assert "restart" not in system.did


def test_a_wheel_of_something_else_is_refused(boat: Boat, tmp_path: Path) -> None:
    system = FakeSystem(boat.site)
    wrong = make_wheel(tmp_path, files={"evil.pth": b"import os"})
    assert boat.update(system, wrong).state == "refused"
    assert (system.did, boat.files(), boat.left()) == ([], boat.old, [])


def spooled(tmp_path: Path, fill: Callable[[Path], None]) -> Path:
    spool = tmp_path / "spool"
    (spool / "new").mkdir(parents=True)
    (spool / "start").touch()
    fill(spool / "new")
    return spool


def test_the_wheel_of_the_page_is_installed_and_gone(boat: Boat, tmp_path: Path) -> None:
    spool = spooled(tmp_path, lambda new: (make_wheel(new, files=NEW), None)[1])
    result = update_from_spool(boat.updater(FakeSystem(boat.site)), spool)
    assert result is not None
    assert result.state == "done"
    assert boat.is_new()
    assert list(spool.iterdir()) == []
    assert update_from_spool(boat.updater(FakeSystem(boat.site)), spool) is None


def link(new: Path) -> None:
    make_wheel(new.parent, files=NEW)
    (new / "mavboat-0.2.0-py3-none-any.whl").symlink_to(new.parent / "mavboat-0.2.0-py3-none-any.whl")


def pipe(new: Path) -> None:
    os.mkfifo(new / "mavboat-0.2.0-py3-none-any.whl")


def two(new: Path) -> None:
    make_wheel(new, files=NEW)
    make_wheel(new, version="0.3.0")


def elsewhere(new: Path) -> None:
    make_wheel(new, files=NEW)
    new.rename(new.parent.parent / "other")
    new.symlink_to(new.parent.parent / "other")


@pytest.mark.parametrize("fill", [link, pipe, two, elsewhere, lambda new: None, lambda new: new.rmdir()])
def test_root_follows_no_link_and_waits_for_no_pipe(
    boat: Boat, tmp_path: Path, fill: Callable[[Path], None]
) -> None:
    spool = spooled(tmp_path, fill)
    result = update_from_spool(boat.updater(FakeSystem(boat.site)), spool)
    assert result is not None
    assert result.state == "refused"
    assert boat.files() == boat.old
    assert not (spool / "start").exists()
    assert not (spool / "new").is_symlink()


@pytest.mark.parametrize(
    ("text", "is_armed"),
    [
        ('{"armed": false}', False),
        ('{"armed": true}', True),
        ("{}", True),
        ('{"armed": null}', True),
        ("", True),
    ],
)
def test_only_a_fresh_status_that_says_so_is_disarmed(tmp_path: Path, text: str, is_armed: bool) -> None:
    path = tmp_path / "status.json"
    path.write_text(text, encoding="ascii")
    written_s = path.stat().st_mtime
    assert read_armed(path, written_s + 1.0) is is_armed
    assert read_armed(path, written_s + 60.0)
    linked = tmp_path / "link.json"
    linked.symlink_to(path)
    assert read_armed(linked, written_s)
    os.mkfifo(tmp_path / "pipe")
    assert read_armed(tmp_path / "pipe", written_s)
    assert read_armed(tmp_path / "gone", written_s)
