"""How a call waits. A call is a generator of steps: it runs with the link's lock held, and each `yield` gives the most
seconds to wait for a change of the link. run() waits in the caller's thread, run_async() in an event loop."""
from __future__ import annotations

import asyncio
import contextlib
from typing import TYPE_CHECKING, Generator, TypeVar

if TYPE_CHECKING:
    from brume.link import Link

T = TypeVar('T')
Steps = Generator[float, None, T]


def run(link: Link, steps: Steps[T]) -> T:
    """What the steps return. The thread waits."""
    link.check_process()
    with link.changed:
        try:
            while True:
                link.changed.wait(next(steps))
        except StopIteration as done:
            result: T = done.value
            return result
        finally:
            steps.close()


async def run_async(link: Link, steps: Steps[T]) -> T:
    """What the steps return. Other tasks run meanwhile; a cancelled one waits no longer."""
    link.check_process()
    loop, woken = asyncio.get_running_loop(), asyncio.Event()

    def wake() -> None:  # in the link's thread
        with contextlib.suppress(RuntimeError):  # the loop has ended
            loop.call_soon_threadsafe(woken.set)
    link.watchers.add(wake)
    try:
        while True:
            woken.clear()
            with link.changed:
                seconds = next(steps)
            late = loop.call_later(seconds, woken.set)
            try:
                await woken.wait()
            finally:
                late.cancel()
    except StopIteration as done:
        result: T = done.value
        return result
    finally:
        link.watchers.discard(wake)
        with link.changed:
            steps.close()
