"""What to do about a port that another program has."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager

from companion.core.errors import BoatError, LinkError


class PortInUseError(BoatError):
    """Another program uses the port."""

    exit_code = 2


@contextmanager
def busy_port_explained(advice: str) -> Iterator[None]:
    """Explain what to do about a port in use. advice: how to choose another port.

    Raises:
        PortInUseError: in place of the LinkError.
    """
    try:
        yield
    except LinkError as error:
        if os.strerror(errno.EADDRINUSE) not in str(error):
            raise
        raise PortInUseError(
            f"{error}: another program has this port, perhaps an earlier start of this one (ss -tulpn lists "
            f"them): end it, or {advice}"
        ) from None
