"""A Debian system with its own systemd as process 1, in namespaces of this machine, thrown away afterwards.

Its root is an overlay over a Debian root folder: MAVBOAT_DEBIAN_ROOT (made by debootstrap), or else this
machine's own. Nothing is written below it. The programs under test are bound in from the environment that
runs the tests. Of its own units only the journal starts, and what was installed. It shares this machine's
network, so that a station reaches the boat.
"""

import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from patience import MOMENT_S
from programs import until

HOST_ROOT = Path(os.environ.get("MAVBOAT_DEBIAN_ROOT", "/"))
PROJECT = Path(__file__).parents[3]
_NEEDED = ("unshare", "nsenter", "mount", "chroot", "useradd", "systemctl")
_NAMESPACES = ("--mount", "--pid", "--cgroup", "--uts", "--ipc")

# As systemd-nspawn does. With /proc/sys and /sys read-only, no udev and no sysctl touches this machine.
_MOUNT = """
set -eu
mount --make-rprivate /
mkdir -p {place}/upper {place}/work {place}/root
mount -t tmpfs -o mode=755 none {place}
mkdir -p {place}/upper {place}/work {place}/root
mount -t overlay -o lowerdir={lower},upperdir={place}/upper,workdir={place}/work overlay {root}
mount -t proc proc {root}/proc
mount --bind {root}/proc/sys {root}/proc/sys
mount -o remount,bind,ro {root}/proc/sys
mount -t sysfs sysfs {root}/sys
mount -t cgroup2 cgroup2 {root}/sys/fs/cgroup
mount -o remount,bind,ro {root}/sys
mount -t tmpfs -o mode=755 tmpfs {root}/run
mount -t tmpfs -o mode=755 tmpfs {root}/dev
for node in null zero full random urandom tty; do cp -a /dev/$node {root}/dev/$node; done
mkdir {root}/dev/pts {root}/dev/shm
mount -t devpts -o newinstance,ptmxmode=0666 devpts {root}/dev/pts
ln -s pts/ptmx {root}/dev/ptmx
mount -t tmpfs -o mode=1777 tmpfs {root}/dev/shm
for folder in {bound}; do
    mkdir -p {root}$folder
    mount --bind $folder {root}$folder
    mount -o remount,bind,ro {root}$folder
    while folder=$(dirname $folder); [ $folder != / ]; do chmod o+x {root}$folder; done
done
: > {root}/etc/fstab
echo 0123456789abcdef0123456789abcdef > {root}/etc/machine-id
rm -rf {root}/etc/systemd/system/*.wants
for target in basic local-fs multi-user sockets sysinit timers; do
    rm -rf {root}/usr/lib/systemd/system/$target.target.wants
done
mkdir {root}/etc/systemd/system/sysinit.target.wants
ln -s /lib/systemd/system/systemd-journald.service {root}/etc/systemd/system/sysinit.target.wants/
"""
_BOOT = """
exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin container=test chroot {root} \
    /lib/systemd/systemd --system --unit=multi-user.target --log-target=journal --show-status=no
"""


def _cgroups() -> Path | None:
    """Where the unified hierarchy of control groups is mounted."""
    for line in Path("/proc/mounts").read_text(encoding="utf-8").splitlines():
        _, folder, kind, *_ = line.split()
        if kind == "cgroup2":
            return Path(folder)
    return None


def why_not() -> str:
    """Why no such system can be started here; empty if it can."""
    if os.geteuid() != 0:
        return "only root can start a system in namespaces"
    if not (HOST_ROOT / "lib/systemd/systemd").exists() or not (HOST_ROOT / "etc/debian_version").exists():
        return f"{HOST_ROOT} is not the root of a Debian with systemd"
    if not (HOST_ROOT / "usr/bin/udevadm").exists() and not (HOST_ROOT / "bin/udevadm").exists():
        return f"{HOST_ROOT} is the root of a Debian without udev"
    if PROJECT.is_relative_to("/tmp"):  # noqa: S108
        return "the project lies below /tmp, of which the unit has its own (PrivateTmp)"
    if _cgroups() is None:
        return "no unified hierarchy of control groups is mounted"
    missing = [name for name in _NEEDED if shutil.which(name) is None]
    if missing:
        return f"{', '.join(missing)}: not installed"
    probe = [
        "unshare",
        *_NAMESPACES,
        "--fork",
        "sh",
        "-c",
        "mount -t tmpfs none /mnt && mount -t cgroup2 none /mnt",
    ]
    done = subprocess.run(probe, capture_output=True, text=True, timeout=MOMENT_S, check=False)
    return "" if done.returncode == 0 else f"no namespaces here: {' '.join(done.stderr.split())}"


def bound_folders() -> list[str]:
    """The programs under test: the project, and the Python that runs the tests."""
    folders = {PROJECT, Path(sys.prefix), Path(sys.base_prefix)}
    return sorted(str(one) for one in folders if not folders & set(one.parents))


class SystemdMachine:
    """The running system. prepare: shell lines run with $root before it boots."""

    def __init__(self, place: Path, prepare: str) -> None:
        self._place = place
        place.mkdir()
        root = place / "root"
        values = {"place": place, "root": root, "lower": HOST_ROOT, "bound": " ".join(bound_folders())}
        script = place.parent / "boot.sh"
        script.write_text(f"{_MOUNT}\nroot={root}\n{prepare}\n{_BOOT}".format(**values), encoding="utf-8")
        self.said = place.parent / "boot.txt"
        cgroups = _cgroups()
        assert cgroups is not None
        # its namespace's root: systems that run at the same time do not see each other's units
        self._cgroup = cgroups / f"mavboat-test-{os.getpid()}-{place.parent.name}"
        self._cgroup.mkdir()
        enter = f"echo $$ > {self._cgroup}/cgroup.procs; exec unshare {shlex.join(_NAMESPACES)}"
        with self.said.open("wb") as said:
            self._process = subprocess.Popen(
                ["sh", "-c", f"{enter} --fork --kill-child bash {script}"],
                stdin=subprocess.DEVNULL,
                stdout=said,
                stderr=said,
                start_new_session=True,
            )

    def run(self, *command: str, check: bool = False) -> str:
        """Run a command inside; returns its output."""
        inside = ["nsenter", f"--target={self._first()}", *_NAMESPACES, "--root", "--wd"]
        done = subprocess.run(
            [*inside, *command], capture_output=True, text=True, timeout=MOMENT_S, check=False
        )
        assert not check or done.returncode == 0, f"{shlex.join(command)}: {done.stdout}{done.stderr}"
        return done.stdout

    def is_up(self) -> bool:
        """Whether its systemd answers."""
        return bool(self._children()) and bool(self.show("multi-user.target", "ActiveState"))

    def show(self, unit: str, *names: str) -> dict[str, str]:
        """Properties of a unit."""
        options = [f"--property={name}" for name in names]
        lines = self.run("systemctl", "show", unit, *options).splitlines()
        return dict(line.split("=", 1) for line in lines if "=" in line)

    def until(self, condition: Callable[[], object], what: str, timeout_s: float = MOMENT_S) -> None:
        """Wait until something holds; the journal explains why it does not."""
        give_up_s = time.monotonic() + timeout_s
        while not condition():
            has_ended = self._process.poll() is not None
            if has_ended or time.monotonic() > give_up_s:
                journal = "" if has_ended else self.run("journalctl", "--no-pager", "-n", "60")
                raise AssertionError(f"not {what}: {self.said.read_text(encoding='utf-8')}{journal}")
            time.sleep(0.02)

    def close(self) -> None:
        """End it, with all its processes."""
        if self._process.poll() is None:
            os.kill(self._process.pid, signal.SIGKILL)  # --kill-child: process 1 too, and so all others
        self._process.wait(MOMENT_S)
        events = self._cgroup / "cgroup.events"
        until(lambda: "populated 0" in events.read_text(encoding="utf-8"))
        for folder, _, _ in os.walk(self._cgroup, topdown=False):
            Path(folder).rmdir()

    def _first(self) -> int:
        """Process 1 of the system, by its number here."""
        return self._children()[0]

    def _children(self) -> list[int]:
        pid = self._process.pid
        return [
            int(one) for one in Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="utf-8").split()
        ]
