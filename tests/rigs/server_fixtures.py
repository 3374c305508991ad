"""A plugin for tests of the page's server: those that are coroutines are run inside the asynchronous contexts
among their fixtures.
"""

import asyncio
import inspect
from contextlib import AbstractAsyncContextManager, AsyncExitStack

import pytest
from shore_server import Server, serving


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Run a test that is a coroutine."""
    test = pyfuncitem.obj
    if not inspect.iscoroutinefunction(test):
        return None

    async def run() -> None:
        async with AsyncExitStack() as contexts:
            values = {name: pyfuncitem.funcargs[name] for name in inspect.signature(test).parameters}
            for name, value in values.items():
                if isinstance(value, AbstractAsyncContextManager):
                    values[name] = await contexts.enter_async_context(value)
            await test(**values)

    asyncio.run(run())
    return True


@pytest.fixture
def server() -> AbstractAsyncContextManager[Server]:
    """A server with a PIN, a fleet of fakes and no map."""
    return serving()
