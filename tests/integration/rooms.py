#!/usr/bin/env python3
"""Rooms of the real server: rooms.py SERVER PACKAGE."""
import concurrent.futures
import json
import os
import shutil
import subprocess
import tempfile
import time
import unittest
import urllib.error
import urllib.request

from python_server import COLD, PATIENCE, Serving, brume, program


def eventually(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, 'it did not come in time'
        time.sleep(0.05)


def ask(url, method, token=None, data=None):
    headers = {'Authorization': f'Bearer {token}'} if token else {}
    try:
        request = urllib.request.Request(url, data=data, method=method, headers=headers)
        with urllib.request.urlopen(request, timeout=COLD) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as answer:
        return answer.code, answer.read().decode()


def post(url, token=None, data=b''):
    return ask(url, 'POST', token, data)


def rooms(server):
    with urllib.request.urlopen(f'{server.url}/rooms') as answer:
        return {room['name']: room for room in json.load(answer)['rooms']}


SCENES = os.path.join(os.path.dirname(__file__), '../../server/scenes')
SOON = PATIENCE / 5  # s; it takes longer to load the slow scene three times, however slow the machine is


def write_slow_scene(folder, count=120_000):
    """slow.toml, of so many tetrahedra: it takes seconds to load, and shaders are compiled after that."""
    corners = ''.join(f'{i % 1000 * 3 + (k == 3)} {int(k == 1)} {i // 1000 * 3 + (k == 2)} 1\n'
                      for i in range(count) for k in range(4))
    cells = ''.join(f'4 {4 * i} {4 * i + 1} {4 * i + 2} {4 * i + 3}\n' for i in range(count))
    with open(f'{folder}/slow.ply', 'w') as file:
        file.write(f'ply\nformat ascii 1.0\nelement vertex {4 * count}\nproperty float x\nproperty float y\n'
                   f'property float z\nproperty float sigma_t\nelement tetrahedron {count}\n'
                   f'property list uchar int vertex_indices\nend_header\n{corners}{cells}')
    with open(f'{folder}/slow.toml', 'w') as file:
        file.write('[medium]\nmodel = "tetrahedra"\nlayout = "file"\nfile = "slow.ply"\n')


class Rooms(Serving):
    def look(self, url):
        view = brume.connect(url, size=(160, 96), timeout=COLD)
        self.addCleanup(view.close)
        return view

    def test_rooms_have_their_own_scenes_and_settings(self):
        with tempfile.TemporaryDirectory() as folder:
            server = self.serve('--room', 'lab=tubes', '--record', f'{folder}/class.rec')
            home, lab = self.look(server.url), self.look(f'{server.url}/r/lab/')
            self.assertEqual((home.scene, lab.scene), ('cloud', 'tubes'))
            before = home.state.settings['medium.extinction']
            lab.set('medium.extinction', before + 7)
            self.assertEqual(home.state.settings['medium.extinction'], before)
            self.assertNotEqual(home.frame().jpeg, lab.frame().jpeg)
            lab.pause()
            ticks = home.state.tick
            eventually(lambda: home.state.tick > ticks + 30)
            self.assertEqual(home.state.viewers, 1)
            self.assertEqual(rooms(server)['lab']['viewers'], 1)
            # Another scene in a room leaves the others as they are.
            lab.show_scene('plume')
            self.assertEqual((home.scene, lab.scene), ('cloud', 'plume'))
            self.assertEqual(server.stop(), 0)
            written = sorted(os.listdir(folder))
            self.assertEqual(written, ['class-lab-2.rec', 'class-lab.rec', 'class.rec'])

    def test_operators_open_and_close_rooms(self):
        server = self.serve('--max-rooms', '1')
        self.assertEqual(post(f'{server.url}/rooms/open?name=one&scene=none')[0], 422)
        self.assertEqual(post(f'{server.url}/rooms/open?name=one&scene=tubes'), (201, "room 'one' is open at /r/one/\n"))
        self.assertEqual(post(f'{server.url}/rooms/open?name=one&scene=tubes')[1], "there is a room 'one' already\n")
        self.assertIn('as many as --max-rooms allows', post(f'{server.url}/rooms/open?name=two&scene=tubes')[1])
        view = self.look(f'{server.url}/r/one/')
        self.assertEqual(view.scene, 'tubes')
        view.frame()
        self.assertEqual(post(f'{server.url}/rooms/close?name=one')[0], 200)
        with self.assertRaises(brume.BrumeError):
            for _ in range(1000):
                view.frame(timeout=1)
        self.assertEqual(list(rooms(server)), [''])
        self.assertEqual(post(f'{server.url}/rooms/close?name=one')[0], 422)
        self.assertEqual(post(f'{server.url}/rooms/open?name=two&scene=tubes')[0], 201)  # its place is free again
        self.assertEqual(server.stop(), 0)

    def test_a_room_may_show_an_uploaded_cloud_or_the_scene_of_the_start(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(os.path.join(SCENES, 'tubes.toml'), f'{folder}/own.toml')
            server = self.serve('--cloud-dir', f'{folder}/clouds', '--scene', f'{folder}/own.toml')
            self.assertEqual(post(f'{server.url}/rooms/open?name=start&scene=own')[0], 201)
            points = b'ply\nformat ascii 1.0\nelement vertex 1\n' + b''.join(
                f'property float {axis}\n'.encode() for axis in 'xyz') + b'end_header\n2 0 0\n'
            self.assertEqual(post(f'{server.url}/cloud?name=mine', data=points)[0], 200)
            self.assertEqual(post(f'{server.url}/rooms/open?name=cloud&scene=mine')[0], 201)
            self.assertEqual({name: room['scene'] for name, room in rooms(server).items()},
                             {'': 'mine', 'start': 'tubes', 'cloud': 'mine'})
            self.look(f'{server.url}/r/cloud/').frame()
            self.assertEqual(post(f'{server.url}/rooms/open?name=wrong&scene=own.toml')[0], 422)

    def test_rooms_sleep_that_nobody_looks_at(self):
        server = self.serve('--room', 'lab=cloud', '--idle-rooms', 'sleep')
        eventually(lambda: rooms(server)['lab']['tick'] == rooms(server)['lab']['tick'] and
                   rooms(server)['']['tick'] > 200)
        asleep = rooms(server)['lab']['tick']
        ticks = rooms(server)['']['tick']
        eventually(lambda: rooms(server)['']['tick'] > ticks + 60)
        self.assertEqual(rooms(server)['lab']['tick'], asleep, 'it stands still')
        lab = self.look(f'{server.url}/r/lab/')
        first = lab.frame().tick
        eventually(lambda: lab.frame().tick > first)
        self.assertLess(first, ticks, 'no time has passed for it')

    def test_what_is_wrong_with_rooms_is_said_at_the_start(self):
        for options, said in (
                (['--room', 'lab=none'], 'none'),
                (['--room', 'a/b=cloud'], 'allowed: NAME=SCENE'),
                (['--room', 'a=cloud', '--room', 'a=tubes'], 'there is a room of that name already'),
                (['--room', 'a=cloud', '--max-rooms', '0'], '--max-rooms allows 0')):
            done = subprocess.run([program, '--port', '0', '--ahead', 'off', *options], timeout=COLD, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertNotEqual(done.returncode, 0, options)
            last = done.stderr.strip().splitlines()[-1]
            self.assertIn(said, last, options)

    def test_people_are_those_of_a_room(self):
        server = self.serve('--room', 'lab=cloud')
        home, lab = self.look(server.url), self.look(f'{server.url}/r/lab/')
        home.appear(name='Ann')
        lab.appear(name='Bob')
        eventually(lambda: lab.people.people and home.people.people)
        self.assertEqual([one.name for one in home.people.people], ['Ann'])
        self.assertEqual([one.name for one in lab.people.people], ['Bob'])


    def test_a_token_may_be_of_one_room_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            key = f'{folder}/key'
            with open(os.open(key, os.O_WRONLY | os.O_CREAT, 0o600), 'wb') as file:
                file.write(os.urandom(32))

            def make(role, *more):
                return subprocess.run([program, '--token-key', key, '--make-token', role, *more], text=True,
                                      stdout=subprocess.PIPE, stderr=subprocess.PIPE)

            server = self.serve('--room', 'lab=cloud', '--room', 'den=cloud', '--token-key', key)
            chief, guest = (make(role, '--token-room', 'lab').stdout.strip() for role in ('operator', 'viewer'))
            alone = "this token is good in the room 'lab' alone: below /r/lab/"
            for page in (server.url, f'{server.url}/r/den/'):
                with self.assertRaisesRegex(brume.BrumeError, alone):
                    brume.connect(page, token=guest, timeout=COLD)
            with brume.connect(f'{server.url}/r/lab/', token=guest, size=(96, 64), timeout=COLD) as view:
                view.frame()
            with brume.connect(f'{server.url}/r/lab/', token=chief, size=(96, 64), timeout=COLD) as view:
                view.pause()
            for path in ('metrics', 'viewers', 'rooms', 'scene.toml', 'snapshot.jpg', 'r/den/snapshot.jpg'):
                self.assertEqual(ask(f'{server.url}/{path}', 'GET', chief), (403, alone + '\n'), path)
            for path in ('rooms/open?name=mine&scene=cloud', 'rooms/close?name=lab', 'rooms/close?name=den', 'pause'):
                self.assertEqual(post(f'{server.url}/{path}', chief), (403, alone + '\n'), path)
            self.assertEqual(ask(f'{server.url}/r/lab/metrics', 'GET', chief)[0], 200)
            self.assertEqual(ask(f'{server.url}/r/lab/metrics', 'GET', guest)[0], 403)
            self.assertEqual(ask(f'{server.url}/r/den/scene.toml', 'GET', make('viewer').stdout.strip())[0], 200)
            for wrong in ('', 'a/b', 'z' * 33):
                refused = make('viewer', '--token-room', wrong)
                self.assertIn("allowed: a room's name", refused.stderr)
                self.assertEqual(refused.returncode, 2)
            self.assertEqual(make('viewer', '--token-room', 'z' * 32).returncode, 0)


    def test_a_stop_does_not_wait_for_rooms_that_are_being_opened(self):
        with tempfile.TemporaryDirectory() as folder:
            write_slow_scene(folder)
            server = self.serve('--scene', os.path.join(SCENES, 'cloud.toml'), '--scene-dir', folder)

            def answer(name):
                try:
                    return post(f'{server.url}/rooms/open?name={name}&scene=slow')
                except OSError:  # the connection was closed
                    return None

            def being_opened():  # who answers is at work: this is answered at once else
                try:
                    request = urllib.request.Request(f'{server.url}/rooms/close?name=none', data=b'', method='POST')
                    urllib.request.urlopen(request, timeout=0.5)
                except urllib.error.HTTPError:
                    return False
                except TimeoutError:
                    return True

            with concurrent.futures.ThreadPoolExecutor() as pool:
                answers = [pool.submit(answer, name) for name in ('one', 'two', 'three')]
                eventually(being_opened)
                self.assertFalse(any(one.done() for one in answers), 'they take longer than to notice')
                asked = time.monotonic()
                self.assertEqual(server.stop(), 0)
                self.assertLess(time.monotonic() - asked, SOON)
                for one in answers:
                    self.assertIn(one.result(), (None, (503, 'the server stops\n')))


if __name__ == '__main__':
    unittest.main(argv=['rooms.py'])
