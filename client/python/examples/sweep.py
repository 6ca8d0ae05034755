#!/usr/bin/env python3
"""A setting's values below each other, seen by several viewers at once: sweep.py [ADDRESS [SETTING VALUE...]] writes
the contact sheet sweep.png."""
from __future__ import annotations

import asyncio
import contextlib
import sys

from PIL import Image, ImageDraw
import brume

SIZE = (240, 135)
CAMERAS = ((0, 3, 16), (16, 3, 0), (0.1, 16, 0))  # m: front, side, above
VALUES = ('1', '4', '16', '64')


async def main(address: str = 'http://127.0.0.1:8080', path: str = 'medium.extinction', *values: str) -> None:
    async with contextlib.AsyncExitStack() as stack:
        views = await asyncio.gather(*(stack.enter_async_context(brume.connect_async(address, size=SIZE, quality=95,
                                                                                     keep_size=True)) for _ in CAMERAS))
        before = views[0].state.settings[path]
        await views[0].pause()  # so that nothing but the setting differs
        try:
            rows = values or VALUES
            sheet = Image.new('RGB', (SIZE[0] * len(CAMERAS), SIZE[1] * len(rows)))
            for row, value in enumerate(rows):
                await views[0].set(path, float(value))
                for view, position in zip(views, CAMERAS):
                    view.look(position=position, target=(0, 0, 0))  # from here on a picture shows the value
                for column, frame in enumerate(await asyncio.gather(*(view.frame() for view in views))):
                    sheet.paste(frame.image(), (SIZE[0] * column, SIZE[1] * row))
                ImageDraw.Draw(sheet).text((6, SIZE[1] * row + 4), f'{path} = {value}')
            sheet.save('sweep.png')
        finally:
            await views[0].set_all({path: before, 'simulation.paused': False})

if __name__ == '__main__':
    asyncio.run(main(*sys.argv[1:]))
