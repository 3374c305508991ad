"""Names of USB adapters, from the folders that the kernel makes for them below /sys."""

from pathlib import Path

import pytest

from companion.app.install.target import InstallError
from companion.app.install.usb_names import HEAD, usb_rules

CP2102 = {"idVendor": "10c4", "idProduct": "ea60", "serial": "0001", "manufacturer": "Silicon Labs"}
CH340 = {"idVendor": "1a86", "idProduct": "7523"}


def plug_in(sys_root: Path, tty: str, socket: str, attributes: dict[str, str], interface: str = "00") -> None:
    """An adapter as Linux shows it: usb device / interface / ttyUSB0, or ttyACM0 in the interface itself."""
    device = sys_root / "devices/platform/soc/usb1" / socket
    port = device / f"{socket}:1.{int(interface)}"
    port.mkdir(parents=True, exist_ok=True)
    for name, value in attributes.items():
        (device / name).write_text(f"{value}\n", encoding="utf-8")
    (port / "bInterfaceNumber").write_text(f"{interface}\n", encoding="utf-8")
    near = port / tty if tty.startswith("ttyUSB") else port
    near.mkdir(exist_ok=True)
    node = sys_root / "class/tty" / tty
    node.mkdir(parents=True)
    (node / "device").symlink_to(near)


def rules(text: str) -> list[str]:
    assert text.startswith(HEAD)
    return text.removeprefix(HEAD).splitlines()


def test_an_adapter_with_a_serial_number_is_known_wherever_it_is_plugged_in(tmp_path: Path) -> None:
    plug_in(tmp_path, "ttyUSB0", "1-1.3", CP2102)
    assert rules(usb_rules(["compass=/dev/ttyUSB0"], sys_root=tmp_path)) == [
        'SUBSYSTEM=="tty", ATTRS{idVendor}=="10c4", ATTRS{idProduct}=="ea60", ATTRS{serial}=="0001", '
        'SYMLINK+="mavboat-compass"'
    ]


@pytest.mark.parametrize("serial", [None, "", 'a", RUN+="x', "two words"])
def test_an_adapter_without_one_is_known_by_its_socket(tmp_path: Path, serial: str | None) -> None:
    plug_in(tmp_path, "ttyUSB1", "1-1.4", CH340 if serial is None else {**CH340, "serial": serial})
    assert rules(usb_rules(["gnss=/dev/ttyUSB1"], sys_root=tmp_path)) == [
        'SUBSYSTEM=="tty", ATTRS{idVendor}=="1a86", ATTRS{idProduct}=="7523", KERNELS=="1-1.4", '
        'SYMLINK+="mavboat-gnss"'
    ]


def test_adapters_that_share_a_serial_number_are_known_by_their_sockets(tmp_path: Path) -> None:
    """As VESCs on USB: usb-STMicroelectronics_ChibiOS_RT_Virtual_COM_Port_304 is the name of each."""
    vesc = {"idVendor": "0483", "idProduct": "5740", "serial": "304"}
    plug_in(tmp_path, "ttyACM0", "1-1.3", vesc)
    plug_in(tmp_path, "ttyACM1", "1-1.4", vesc)
    plug_in(tmp_path, "ttyUSB0", "1-1.5", CP2102)
    options = ["left=/dev/ttyACM0", "lidar=/dev/ttyUSB0", "right=/dev/ttyACM1"]
    left, lidar, right = rules(usb_rules(options, sys_root=tmp_path))
    assert 'KERNELS=="1-1.3"' in left
    assert 'KERNELS=="1-1.4"' in right
    assert 'ATTRS{serial}=="0001"' in lidar


def test_names_given_before_stay_and_a_name_given_again_moves(tmp_path: Path) -> None:
    plug_in(tmp_path, "ttyUSB0", "1-1.3", CP2102)
    plug_in(tmp_path, "ttyUSB1", "1-1.4", CH340)
    first = usb_rules(["compass=/dev/ttyUSB0", "gnss=/dev/ttyUSB1"], sys_root=tmp_path)
    again = usb_rules(["compass=/dev/ttyUSB1"], first, tmp_path)
    compass, gnss = rules(again)
    assert 'KERNELS=="1-1.4"' in compass
    assert gnss == rules(first)[1]


@pytest.mark.parametrize(
    "option",
    ["", "compass", "compass=", "=/dev/ttyUSB0", "Compass=/dev/ttyUSB0", 'a"=/dev/ttyUSB0', "x=ttyUSB0"],
)
def test_an_option_that_is_no_name_and_device_is_refused(tmp_path: Path, option: str) -> None:
    plug_in(tmp_path, "ttyUSB0", "1-1.3", CP2102)
    with pytest.raises(InstallError, match="expected NAME=/dev/"):
        usb_rules([option], sys_root=tmp_path)
