"""Waits for links on asyncio, in programs other than the boat's."""

import asyncio
from collections.abc import Collection


async def readable(filenos: Collection[int], longest_s: float) -> None:
    """Until one of the descriptors has something to read, or for so long."""
    loop, came = asyncio.get_running_loop(), asyncio.Event()
    for number in filenos:
        loop.add_reader(number, came.set)
    try:
        async with asyncio.timeout(longest_s):
            await came.wait()
    except TimeoutError:
        pass
    finally:
        for number in filenos:
            loop.remove_reader(number)
