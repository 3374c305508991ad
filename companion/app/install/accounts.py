"""Steps that make or remove groups and users, by the programs of the package passwd."""

from collections.abc import Sequence
from pathlib import Path

from companion.app.install.target import Target

USER = "mavboat"
_NO_LOGIN = "/usr/sbin/nologin"


class Group:
    """A system group."""

    def __init__(self, target: Target, name: str) -> None:
        self._target = target
        self._name = name

    def describe(self) -> str:
        """What it does."""
        return f"make the group {self._name}"

    def is_done(self) -> bool:
        """Whether there is such a group."""
        return self._name in self._target.groups()

    def apply(self) -> None:
        """Make it."""
        self._target.run("groupadd", "--system", *self._target.accounts_option(), self._name)

    def undo(self) -> None:
        """Remove it."""
        self._target.run("groupdel", *self._target.accounts_option(), self._name)


class User:
    """A system user that cannot log in, with a group of its own, as a member of other groups."""

    def __init__(self, target: Target, name: str, groups: Sequence[str], home: Path) -> None:
        self._target = target
        self._name = name
        self._groups = groups
        self._home = home
        self._missing: list[str] | None = None  # groups that an existing user lacked; None: there was no user

    def describe(self) -> str:
        """What it does."""
        return f"make the user {self._name}, in the groups {', '.join(self._groups)}"

    def is_done(self) -> bool:
        """Whether it exists and is in its groups."""
        return self._name in self._target.users() and not self._lacks()

    def apply(self) -> None:
        """Make it, or add it to the groups that it lacks."""
        target, groups = self._target, ",".join(self._groups)
        if self._name in target.users():
            self._missing = self._lacks()
            target.run("usermod", *target.accounts_option(), "--append", "--groups", groups, self._name)
            return
        self._missing = None
        options = ["--system", "--user-group", "--groups", groups, "--no-create-home"]
        options += ["--home-dir", str(self._home), "--shell", _NO_LOGIN, "--comment", "mavboat companion"]
        target.run("useradd", *target.accounts_option(), *options, self._name)

    def undo(self) -> None:
        """Remove it, or take it out of the groups again."""
        target = self._target
        if self._missing is None:
            target.run("userdel", *target.accounts_option(), self._name)
            if self._name in target.groups():  # userdel removes it where login.defs says so
                target.run("groupdel", *target.accounts_option(), self._name)
            return
        groups = ",".join(self._missing)
        target.run("usermod", *target.accounts_option(), "--remove", "--groups", groups, self._name)

    def _lacks(self) -> list[str]:
        members = self._target.groups()
        return [name for name in self._groups if self._name not in members.get(name, ())]


class NoUser:
    """A user and its own group are removed."""

    def __init__(self, target: Target, user: User, name: str) -> None:
        self._target = target
        self._user = user
        self._name = name

    def describe(self) -> str:
        """What it does."""
        return f"remove the user {self._name} and its group"

    def is_done(self) -> bool:
        """Whether there is no such user."""
        return self._name not in self._target.users()

    def apply(self) -> None:
        """Remove it."""
        self._user.undo()

    def undo(self) -> None:
        """Make it again."""
        self._user.apply()


class Member:
    """A user is a member of a group."""

    def __init__(self, target: Target, user: str, group: str) -> None:
        self._target = target
        self._user = user
        self._group = group

    def describe(self) -> str:
        """What it does."""
        return f"add {self._user} to the group {self._group}"

    def is_done(self) -> bool:
        """Whether it is one already."""
        return self._user in self._target.groups().get(self._group, ())

    def apply(self) -> None:
        """Add it."""
        self._target.run("usermod", *self._target.accounts_option(), "-aG", self._group, self._user)

    def undo(self) -> None:
        """Take it out again."""
        options = [*self._target.accounts_option(), "--remove", "--groups", self._group]
        self._target.run("usermod", *options, self._user)
