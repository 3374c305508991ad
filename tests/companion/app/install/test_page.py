"""`install --page`: the shore page as a service, and what it may then do."""

from pathlib import Path

import pytest
from test_install import FILES_MADE, files, needs_passwd, root, snapshot

from companion.app.cli import run_program
from companion.app.doctor.accounts import check_page
from companion.app.doctor.findings import Examined
from companion.app.install.page import PIN_FILE, PageOptions, shore_unit_text
from companion.app.install.target import Target
from companion.config.boat_config import load_config
from companion.shore.command_line import read_arguments

__all__ = ("root",)

PAGE_FILES = {
    "etc/systemd/system/mavboat-shore.service",
    "etc/systemd/system/multi-user.target.wants/mavboat-shore.service",
}
WIFI = "etc/polkit-1/rules.d/50-mavboat-wifi.rules"


def install(root: Path, *options: str) -> int:
    return run_program(["install", "--root", str(root), *options])


@needs_passwd
def test_the_page_is_installed_only_if_asked_for_and_stays(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = files(root)
    assert install(root) == 0
    assert not files(root) & PAGE_FILES
    owner = (root / "etc/mavboat/boat.toml").stat().st_uid
    assert owner == 0
    assert install(root, "--page") == 0
    assert files(root) - before - {"etc/subuid", "etc/subgid"} == FILES_MADE | PAGE_FILES
    assert "Set the page's PIN: sudo -u mavboat" in capsys.readouterr().out
    user = Target(root).ids("mavboat")
    for name in ("etc/mavboat", "etc/mavboat/boat.toml"):
        status = (root / name).stat()
        assert (status.st_uid, status.st_gid) == user, name

    after = snapshot(root)
    assert install(root) == 0
    assert snapshot(root) == after, "a later installation takes the page away"
    assert run_program(["uninstall", "--root", str(root)]) == 0
    assert not files(root) & PAGE_FILES


@needs_passwd
def test_the_wifi_rule_and_the_map_are_options(root: Path, tmp_path: Path) -> None:
    water = tmp_path / "pond.geojson"
    water.write_text("{}", encoding="utf-8")
    assert install(root, "--page", "--page-wifi", "--page-map", str(water)) == 0
    assert WIFI in files(root)
    assert (root / "etc/mavboat/map.geojson").read_text("utf-8") == "{}"
    unit = (root / "etc/systemd/system/mavboat-shore.service").read_text("utf-8")
    assert " --map /etc/mavboat/map.geojson --wifi\n" in unit
    after = snapshot(root)
    assert install(root, "--page") == 0
    assert snapshot(root) == after
    assert run_program(["uninstall", "--root", str(root)]) == 0
    assert WIFI not in files(root)


@needs_passwd
def test_updates_are_an_option_and_are_removed_with_the_page(root: Path) -> None:
    before = files(root)
    assert install(root, "--page") == 0
    without = files(root)
    assert install(root, "--page", "--page-updates") == 0
    assert files(root) - without == {
        "etc/systemd/system/mavboat-update.path",
        "etc/systemd/system/mavboat-update.service",
        "etc/systemd/system/multi-user.target.wants/mavboat-update.path",
    }
    spool = (root / "var/lib/mavboat/update").stat()
    assert (spool.st_uid, spool.st_mode & 0o777) == (Target(root).ids("mavboat")[0], 0o700)
    unit = (root / "etc/systemd/system/mavboat-shore.service").read_text("utf-8")
    assert " --updates /var/lib/mavboat/update\n" in unit
    service = (root / "etc/systemd/system/mavboat-update.service").read_text("utf-8")
    assert "-m companion update --spool /var/lib/mavboat/update\n" in service
    assert "$" not in service
    after = snapshot(root)
    assert install(root, "--page") == 0
    assert snapshot(root) == after
    assert run_program(["uninstall", "--root", str(root)]) == 0
    assert not {one for one in files(root) - before if "update" in one}


@pytest.mark.parametrize("option", [["--page-wifi"], ["--page-updates"], ["--page-map", "pond.geojson"]])
def test_options_of_the_page_need_the_page(
    root: Path, option: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    (root / "pond.geojson").touch()
    option = [str(root / word) if word.endswith("json") else word for word in option]
    assert install(root, *option) == 2
    assert "need --page" in capsys.readouterr().err


@pytest.mark.parametrize("has_wifi", [False, True])
def test_the_unit_starts_the_page_with_options_that_it_has(has_wifi: bool) -> None:
    unit = shore_unit_text(Path("/opt/mavboat/.venv/bin"), PageOptions(has_wifi), has_map=True)
    (line,) = [one for one in unit.splitlines() if one.startswith("ExecStart=")]
    program, *arguments = line.removeprefix("ExecStart=").split()
    assert program == "/opt/mavboat/.venv/bin/boat-shore"
    given = read_arguments(arguments)
    assert (given.listen, given.connect) == ("0.0.0.0:80", "tcp:127.0.0.1:5760")
    assert (given.wifi, given.config, given.pin_file) == (has_wifi, Path("/etc/mavboat/boat.toml"), PIN_FILE)
    assert "$" not in unit


@needs_passwd
def test_the_doctor_misses_a_pin_a_link_and_the_start(root: Path) -> None:
    def told() -> list[str]:
        examined = Examined(Target(root), load_config(root / "etc/mavboat/boat.toml"))
        return [f"{one.verdict}: {one.text}" for one in check_page(examined)]

    assert install(root) == 0
    assert told() == []
    assert install(root, "--page") == 0
    assert told() == ["warning: no PIN is set: it only shows"]
    (root / str(PIN_FILE).lstrip("/")).touch()
    assert told() == ["fine: starts with the computer, and has a PIN"]
    file = root / "etc/mavboat/boat.toml"
    file.write_text(file.read_text("utf-8").replace("tcpin:0.0.0.0:5760", "tcpin:0.0.0.0:5761"), "utf-8")
    assert told() == ["failed: the boat has no link for it at TCP port 5760"]
    (root / "etc/systemd/system/multi-user.target.wants/mavboat-shore.service").unlink()
    assert told() == ["warning: does not start with the computer"]
