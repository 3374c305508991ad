"""Steps that make or remove groups and users, by the programs of the package passwd."""

from collections.abc import Sequence
from pathlib import Path

from companion.app.install.steps import InstallStep
from companion.app.install.target import Target

USER = "mavboat"
_NO_LOGIN = "/usr/sbin/nologin"


def group_step(target: Target, name: str) -> InstallStep:
    """Make a system group."""
    option = target.accounts_option()
    return InstallStep(
        f"make the group {name}",
        lambda: name in target.groups(),
        lambda: target.run("groupadd", "--system", *option, name),
        lambda: target.run("groupdel", *option, name),
    )


def user_step(target: Target, name: str, groups: Sequence[str], home: Path) -> InstallStep:
    """Make a system user that cannot log in, with a group of its own, as a member of other groups; one that
    exists is added to the groups that it lacks.
    """
    option = target.accounts_option()
    added: list[str] | None = None  # groups that an existing user lacked; None: there was no user

    def lacks() -> list[str]:
        members = target.groups()
        return [group for group in groups if name not in members.get(group, ())]

    def apply() -> None:
        nonlocal added
        added = lacks() if name in target.users() else None
        if added is not None:
            target.run("usermod", *option, "--append", "--groups", ",".join(groups), name)
            return
        options = ["--system", "--user-group", "--groups", ",".join(groups), "--no-create-home"]
        options += ["--home-dir", str(home), "--shell", _NO_LOGIN, "--comment", "mavboat companion"]
        target.run("useradd", *option, *options, name)

    def undo() -> None:
        if added is not None:
            target.run("usermod", *option, "--remove", "--groups", ",".join(added), name)
            return
        target.run("userdel", *option, name)
        if name in target.groups():  # userdel removes it where login.defs says so
            target.run("groupdel", *option, name)

    text = f"make the user {name}, in the groups {', '.join(groups)}"
    return InstallStep(text, lambda: name in target.users() and not lacks(), apply, undo)


def no_user_step(target: Target, name: str, user: InstallStep) -> InstallStep:
    """Remove the user that a step makes."""
    text = f"remove the user {name} and its group"
    return InstallStep(text, lambda: name not in target.users(), user.undo, user.apply)


def member_step(target: Target, user: str, group: str) -> InstallStep:
    """Add a user to a group."""
    option = target.accounts_option()
    return InstallStep(
        f"add {user} to the group {group}",
        lambda: user in target.groups().get(group, ()),
        lambda: target.run("usermod", *option, "-aG", group, user),
        lambda: target.run("usermod", *option, "--remove", "--groups", group, user),
    )
