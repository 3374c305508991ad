"""The page's program as the emulator's child: it comes, goes and dies without the boat."""

import socket
from pathlib import Path

import pytest
from page_rig import start_shore
from programs import Program, processes_of, until

pytestmark = pytest.mark.realtime


def test_the_page_ends_with_its_emulator_even_by_kill_9(tmp_path: Path) -> None:
    boat = start_shore(tmp_path / "room")
    boat.program.kill()
    boat.program.hang_up()
    until(lambda: processes_of(boat.program.pid) == [])


def test_a_page_whose_port_is_taken_says_so_and_the_boat_sails(tmp_path: Path) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        taken = f"127.0.0.1:{other.getsockname()[1]}"
        arguments = ["serve", "lake", "--shore", "--shore-at", taken, "--tcp", "0", "--no-udp"]
        program = Program(tmp_path / "room", ["boat-sitl", *arguments, "--state", "none"])
        try:
            program.wait_for("the page's program ended with")
            program.wait_for("^boat-sitl: ready")
            assert program.is_running
            assert taken in program.err
        finally:
            program.close()
