#!/usr/bin/env python3
"""People, undo and stills of the Python package against a real server: python_people.py SERVER PACKAGE."""
import asyncio
import io
import time
import unittest

from PIL import Image
from python_server import PATIENCE, OneServer, brume


def eventually(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, 'it did not come in time'
        time.sleep(0.02)


class People(OneServer):
    def test_people_see_each_other(self):
        ann, bob = self.viewer(), self.viewer()
        self.assertEqual(ann.people, brume.People())
        ann.appear(name='Ann')
        bob.appear(name='<b>Bob</b>', pointer=((0, 2, 26), (0, -2, -26)))
        eventually(lambda: any(one.pointer for one in ann.people.people))
        people = ann.people
        self.assertEqual([one.name for one in people.people], ['Ann', '<b>Bob</b>'])
        self.assertEqual(people.count, 2)
        self.assertFalse(people.named('Ann').known)
        self.assertNotEqual(people.named('Ann').colour, people.named('<b>Bob</b>').colour)
        self.assertLess(max(map(abs, people.named('<b>Bob</b>').pointer)), 15, 'in the cloud')
        bob.appear(pointer=None)
        eventually(lambda: not any(one.pointer for one in ann.people.people))
        self.assertEqual(ann.people.named('<b>Bob</b>').name, '<b>Bob</b>', 'what is not given stays')
        with self.assertRaises(brume.BrumeError):
            ann.people.named('nobody')
        with self.assertRaises(brume.BrumeError):
            ann.appear(name='x' * 33)

    def test_frames_follow_a_person(self):
        ann, bob = self.viewer(), self.viewer()
        ann.appear(name='Ann')
        bob.appear(name='Bob')
        ann.look(position=(3, 6, 26), size=(192, 96))
        ann.frame()
        eventually(lambda: any(one.name == 'Ann' for one in bob.people.people))
        leader = bob.people.named('Ann').id
        bob.appear(follow=leader)
        eventually(lambda: bob.frame().follows == leader)
        frame = bob.frame()
        self.assertEqual(frame.position, (3, 6, 26))
        self.assertEqual((frame.width, frame.height), (192, 96))
        bob.appear(follow=0)
        eventually(lambda: bob.frame().follows == 0)
        ann.present()
        eventually(lambda: bob.people.presenter == leader)
        eventually(lambda: bob.frame().position == (3, 6, 26))
        bob.present(False)  # an operator may
        eventually(lambda: ann.people.presenter == 0)

    def test_the_last_change_is_taken_back(self):
        view = self.viewer()
        before = view.state.settings['medium.extinction']
        view.set('medium.extinction', before + 1)
        self.assertIn('extinction', view.state.undo)
        view.undo()
        self.assertEqual(view.state.settings['medium.extinction'], before)

    def test_stills_leave_out_the_sky(self):
        view = self.viewer()
        whole = Image.open(io.BytesIO(view.snapshot('png', size=(80, 48))))
        self.assertEqual((whole.mode, whole.size), ('RGB', (80, 48)))
        cut = Image.open(io.BytesIO(view.snapshot('png', alpha=True)))
        self.assertEqual((cut.mode, cut.size), ('RGBA', (160, 96)))
        self.assertEqual(cut.getpixel((0, 0))[3], 0, 'sky')
        self.assertGreater(cut.getpixel((80, 48))[3], 100, 'cloud')
        self.assertEqual(view.snapshot('exr')[:4], b'\x76\x2f\x31\x01')
        with self.assertRaises(brume.BrumeError):
            view.snapshot('jpeg', alpha=True)

    def test_the_same_in_an_event_loop(self):
        async def look():
            async with brume.connect_async(self.server.url, size=(160, 96), timeout=PATIENCE) as view:
                view.appear(name='Zoë')
                while not view.people.people:
                    await asyncio.sleep(0.02)
                await view.present()
                await view.present(False)
                return view.people.named('Zoë').role, (await view.snapshot('jpeg'))[:2]
        self.assertEqual(asyncio.run(asyncio.wait_for(look(), PATIENCE)), ('operator', b'\xff\xd8'))


if __name__ == '__main__':
    unittest.main(argv=['python_people.py'])
