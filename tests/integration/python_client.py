#!/usr/bin/env python3
"""The Python package against a real server: python_client.py SERVER PACKAGE. Exit status 77: a package of the
distribution is missing."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

from python_server import COLD, PATIENCE, OneServer, Serving, brume, numpy, package, program


class Package(OneServer):
    def test_the_example_runs_as_it_is(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, pathlib.Path(package) / 'example.py', self.server.url], cwd=folder,
                                  timeout=PATIENCE * 2, text=True, stdout=subprocess.PIPE, check=True)
            lines = done.stdout.splitlines()
            self.assertEqual(len(lines), 5)
            self.assertEqual(len({line.split(' ')[3] for line in lines}), 1, 'one state: ' + done.stdout)
            files = sorted(os.listdir(folder))
            self.assertEqual(files, [f'turn-{i}.jpg' for i in range(5)])
            pictures = [(pathlib.Path(folder) / name).read_bytes() for name in files]
            self.assertTrue(all(data.startswith(b'\xff\xd8\xff') for data in pictures))
            self.assertEqual(len(set(pictures)), 5, 'five views')

    def test_a_frame_shows_the_camera_that_was_asked_for(self):
        view = self.viewer()
        for size in ((160, 96), (96, 128)):
            view.look(position=(3, 6, 26), target=(0, 0, 0), fov=0.5, size=size)
            frame = view.frame()
            self.assertEqual((frame.width, frame.height), size)
            self.assertEqual(frame.position, (3, 6, 26))
            self.assertAlmostEqual(frame.fov, 0.5)
            self.assertEqual(frame.array().shape, (size[1], size[0], 3))
            self.assertGreater(numpy.std(frame.array()), 2, 'a picture of something')
        for x in range(60):  # at every moment of a tick: frames of the camera before are on their way
            time.sleep(x / 60 / 60)
            view.look(position=(x, 6, 26))
            self.assertEqual(view.frame().position, (x, 6, 26))
        view.look(orientation=(0, 0, 0, 1))
        self.assertEqual(view.frame().orientation, (0, 0, 0, 1))
        ticks = [frame.tick for frame in view.frames(5)]
        self.assertEqual(ticks, sorted(set(ticks)), 'each newer than the one before')

    def test_a_view_shows_how_the_picture_is_made(self):
        view = self.viewer()
        view.look(position=(0, 2, 26), target=(0, 0, 0), size=(160, 96))
        picture = view.frame().array().astype(int)
        view.look(view='overdraw')
        self.assertGreater(numpy.abs(view.frame().array() - picture).mean(), 5)
        with self.assertRaisesRegex(brume.BrumeError, 'no view .* there are picture wasted'):
            view.look(view='over')
        view.look(view='picture')
        self.assertLess(numpy.abs(view.frame().array() - picture).mean(), 5)

    def layered(self, view, **camera):
        """The first frame with layers: pictures come without until their shaders are compiled."""
        view.look(layers=4, **camera)
        for frame in view.frames(10_000):
            if frame.layers:
                return frame

    def test_layers_draw_another_view_as_the_server_does(self):
        view = self.viewer()
        view.pause()
        self.addCleanup(view.resume)
        camera = dict(target=(0, 0, 0), fov=0.5, size=(160, 96))
        frame = self.layered(view, position=(0, 2, 20), **camera)
        (layers,) = frame.layers
        nodes = (layers.rows, layers.columns)
        self.assertEqual(layers.colours().shape, (5, *nodes, 3), 'and the sky')
        self.assertEqual(layers.transmittance().shape, (4, *nodes))
        self.assertTrue((numpy.diff(layers.depth(), axis=0).mean(axis=(1, 2)) > 0).all(), 'near to far')
        self.assertIsNone(layers.surface())
        apart = lambda a, b: numpy.abs(a.astype(int) - b.astype(int)).mean()
        self.assertLess(apart(brume.redraw(frame), frame.array()), 0.5, 'from its own place')
        moved = dict(position=(1.5, 2.5, 17))
        drawn = brume.redraw(frame, **moved, target=(0, 0, 0))
        view.look(layers=0, **moved, **camera)
        true = view.frame().array()
        self.assertGreater(apart(frame.array(), true), 3, 'the camera has moved')
        self.assertLess(apart(drawn, true), 0.25 * apart(frame.array(), true))
        with self.assertRaisesRegex(brume.BrumeError, 'no layers'):
            brume.redraw(view.frame())
        with self.assertRaisesRegex(brume.BrumeError, 'from 0 to 8'):
            view.look(layers=9)

    def test_what_arrays_need_is_named_where_it_is_missing(self):
        frame = self.viewer().frame()
        for module, package in (('PIL', 'python3-pil'), ('numpy', 'python3-numpy')):
            with unittest.mock.patch.dict(sys.modules, {module: None}):
                with self.assertRaisesRegex(brume.BrumeError, package):
                    frame.array()
                self.assertTrue(frame.jpeg.startswith(b'\xff\xd8'))

    def test_a_paused_scene_has_one_state_and_gives_its_picture_again(self):
        view = self.viewer(lossless=True, keep_size=True)
        view.pause()
        self.addCleanup(view.resume)
        state = view.state
        self.assertTrue(state.paused)
        frames = [view.frame(), view.frame()]
        rests = lambda: frames[-1] is frames[-2] and frames[-1].lossless
        while not rests() and len(frames) < 20:  # a new plan, however late, gives a new picture
            frames.append(view.frame())
        last = frames[-1]
        self.assertIs(frames[-2], last, 'it comes to rest')
        self.assertEqual({frame.hash for frame in frames}, {state.hash})
        self.assertTrue(last.lossless, 'what rests comes once more as PNG')
        self.assertTrue(last.jpeg.startswith(b'\x89PNG'))

    def test_a_paused_scene_gives_a_picture_after_idleness_and_for_the_same_camera(self):
        view = self.viewer(lossless=True)
        view.pause()
        self.addCleanup(view.resume)
        while not view.frame().lossless:
            pass
        drawn = view.frame()
        with view._link.changed:  # until it looks away by itself
            self.assertTrue(view._link.changed.wait_for(lambda: view._link._hidden, PATIENCE))
        self.assertEqual(view.frame().hash, drawn.hash)
        while not view.frame().lossless:
            pass
        view.look(position=(3, 6, 26))
        while not view.frame().lossless:
            pass
        view.look(position=(3, 6, 26))
        self.assertEqual(view.frame().hash, drawn.hash)

    def test_a_setting_is_in_the_next_picture_and_in_the_state(self):
        view = self.viewer()
        view.pause()
        self.addCleanup(view.resume)
        before = view.frame().array().mean()
        exposure = view.state.settings['render.exposure']
        view.set('render.exposure', exposure * 2)
        self.addCleanup(view.set, 'render.exposure', exposure)
        self.assertAlmostEqual(view.state.settings['render.exposure'], exposure * 2, places=4)
        self.assertGreater(view.frame().array().mean(), before * 1.1)
        self.assertIn('tone map', view.paths['render.exposure']['help'])
        view.set_all({'light.to_light': (0, 3, 4), 'medium.albedo': (1, 0.5, 0.25)})
        self.assertEqual(view.state.settings['medium.albedo'], (1, 0.5, 0.25))
        self.assertAlmostEqual(view.state.settings['light.to_light'][1], 0.6, places=5)

    def test_fogs_and_lights_are_changed_added_and_removed(self):
        view = self.viewer()
        fogs = len(view.state.lists['fog'])
        view.add('fog', extinction=0.5, centre=(0, 1, 0), radius=3)
        self.assertEqual(len(view.state.lists['fog']), fogs + 1)
        self.assertEqual(view.state.lists['fog'][fogs]['centre'], (0, 1, 0))
        view.set(f'fog[{fogs}].extinction', 0.25)
        self.assertEqual(view.state.lists['fog'][fogs]['extinction'], 0.25)
        with self.assertRaisesRegex(brume.BrumeError, r'there is no fog\[9\]'):
            view.set('fog[9].extinction', 1)
        view.remove('fog', fogs)
        self.assertEqual(len(view.state.lists['fog']), fogs)
        view.add('light', type='spot', axis=(0, -2, 0))
        self.assertEqual(view.state.lists['light'][-1]['type'], 'spot')
        self.assertEqual(view.state.lists['light'][-1]['axis'], (0, -1, 0))
        view.remove('light', len(view.state.lists['light']) - 1)
        boxes = len(view.state.lists['box'])
        view.add('box', centre=(1, 2, 3), size=(1, 1, 2))
        view.set_all({f'box[{boxes}].yaw': 0.5, f'box[{boxes}].albedo': (1, 0, 0)})
        self.assertEqual(view.state.lists['box'][boxes],
                         {'centre': (1, 2, 3), 'size': (1, 1, 2), 'yaw': 0.5, 'albedo': (1, 0, 0)})
        view.remove('box', boxes)

    def test_a_push_changes_the_state(self):
        view, other = self.viewer(), self.viewer()
        for viewer in (view, other):
            viewer.frame()
        deadline = time.monotonic() + PATIENCE
        while view.state.viewers != 2:  # told once a second
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        view.pause()
        self.addCleanup(view.resume)
        for act in (lambda: view.push(origin=(0, 0, 26), direction=(0, 0, -1), strength=5),
                    lambda: view.push(origin=(0, 0, 26), direction=(0, 0, -1), push=(10, 0, 0)),
                    lambda: view.move((0, 1, 0)), view.restart):
            before = view.frame()
            act()
            self.assertNotEqual(view.frame(after=before.tick + 5).hash, before.hash)

    def test_refusals_are_exceptions_with_the_servers_line(self):
        view = self.viewer()
        for code, line, act in (
                ('unknown_name', 'no such live setting', lambda: view.set('render.colour', 1)),
                ('out_of_range', 'exposure must be', lambda: view.set('render.exposure', -1)),
                ('out_of_range', 'strength', lambda: view.push((0, 0, 0), (0, 0, 1), strength=1e6))):
            with self.assertRaisesRegex(brume.BrumeError, line) as caught:
                act()
            self.assertEqual(caught.exception.code, code)
        with self.assertRaises(brume.BrumeError) as caught:
            view.look(fov=50)
            view.frame()
        self.assertEqual(caught.exception.code, 'out_of_range')
        view.look(fov=0.8)
        view.frame()  # it goes on

    def test_what_is_wrong_here_spoils_nothing_that_follows(self):
        view = self.viewer()
        for line, act in (('medium.albedo: 2 numbers; allowed: three', lambda: view.set('medium.albedo', (1, 1))),
                          ('size is .*: allowed', lambda: view.look(size=(99999, 5))),
                          ('finite', lambda: view.look(position=(float('nan'), 0, 0)))):
            with self.assertRaisesRegex(brume.BrumeError, line):
                act()
            view.set('render.exposure', view.state.settings['render.exposure'])
            self.assertEqual(view.frame().width, 160)

    def test_a_picture_is_saved_as_its_name_says(self):
        frame = self.viewer().frame()
        with tempfile.TemporaryDirectory() as folder:
            for name, begin in (('one.png', b'\x89PNG'), ('one.jpg', b'\xff\xd8\xff'), ('one', b'\xff\xd8\xff')):
                path = pathlib.Path(folder) / name
                frame.save(path)
                self.assertTrue(path.read_bytes().startswith(begin), name)

    def test_a_standstill_is_told(self):
        view = self.viewer()
        self.assertIsNone(view.state.standstill)
        state = type(view._link.state)  # no server alone says so
        for said, line in ((b'no word from the log', 'no word from the log'), (b'', None), (None, None)):
            with unittest.mock.patch.object(state, 'Standstill', lambda _, text=said: text):
                self.assertEqual(view.state.standstill, line)
        with unittest.mock.patch.object(state, 'Standstill', lambda _: b'no word from the log'):
            with self.assertRaisesRegex(TimeoutError, 'the scene stands still: no word from the log'):
                view.frame(after=10 ** 9, timeout=0.1)

    def test_nothing_is_drawn_for_a_viewer_that_does_not_ask(self):
        view = self.viewer()
        view.frame()
        rendered, ticks = 'brume_frames_total{fate="rendered"}', 'brume_tick_seconds_count'
        deadline = time.monotonic() + PATIENCE
        while True:  # until a second without a frame
            frames, begin = self.server.metric(rendered), self.server.metric(ticks)
            while self.server.metric(ticks) < begin + 60:
                time.sleep(0.05)
            if self.server.metric(rendered) == frames:
                break
            self.assertLess(time.monotonic(), deadline, 'frames for nobody')
        first = view.frame()
        self.assertGreater(view.frame(after=first.tick + 10).tick, first.tick + 10)


class Needs(unittest.TestCase):
    def complaint(self, prepare):
        done = subprocess.run([sys.executable, '-c', f'import sys, types; sys.path.insert(0, {package!r}); {prepare}; '
                               'import brume'], text=True, stderr=subprocess.PIPE, timeout=PATIENCE, check=False)
        self.assertEqual(done.returncode, 1)
        return done.stderr.splitlines()[-1]

    def test_a_missing_module_and_an_old_one_are_named(self):
        for name in ('websockets', 'flatbuffers'):
            self.assertRegex(self.complaint(f'sys.modules[{name!r}] = None'),
                             f'needs the module {name}, version .*, in {re.escape(sys.executable)}: it is missing. .*'
                             f'python3-{name} is for /usr/bin/python3; .* -m pip install {name}')
            old = f'm = types.ModuleType({name!r}); m.__version__ = "1.12"; sys.modules[{name!r}] = m'
            self.assertRegex(self.complaint(old), f'needs the module {name}, .*: here is 1.12')


class Alone(Serving):
    def test_a_viewer_comes_back_when_its_server_does(self):
        server = self.serve()
        with brume.connect(server.url, size=(96, 64)) as view:
            view.look(position=(0, 9, 20))
            view.frame()
            server.stop(kill=True)
            with self.assertRaises((brume.BrumeError, TimeoutError)):
                for _ in range(1000):
                    view.push((0, 0, 0), (0, 0, 1))
            again = self.serve('--port', server.port)
            self.assertEqual(view.frame(timeout=PATIENCE).position, (0, 9, 20))
            again.stop()

    def test_a_viewer_goes_where_a_goodbye_sends_it_with_its_camera(self):
        following = self.serve('--set', 'camera.position=[9,9,9]')
        server = self.serve('--drain-time', '0', '--drain-to', f'{following.url}/')
        with brume.connect(server.url, size=(96, 64)) as view:
            view.look(position=(0, 9, 20))
            view.frame()
            self.assertEqual(server.stop(), 0)
            while following.metric('brume_viewers') < 1:  # frames of the first server may still be on their way
                self.assertEqual(view.frame(timeout=PATIENCE).position, (0, 9, 20))
            self.assertEqual(following.metric('brume_viewers'), 1)

    def test_a_viewer_comes_back_when_nobody_is_where_it_was_sent(self):
        server = self.serve('--drain-time', '0', '--drain-to', 'http://127.0.0.1:1/')
        with brume.connect(server.url, size=(96, 64)) as view:
            view.look(position=(0, 9, 20))
            view.frame()
            self.assertEqual(server.stop(), 0)
            again = self.serve('--port', server.port)
            self.assertEqual(view.frame(timeout=PATIENCE).position, (0, 9, 20))
            again.stop()

    def test_a_goodbye_sends_to_servers_alone_and_never_from_tls_to_none(self):
        for here, go_to, there in (('ws://a/ws', 'https://b/show/', 'wss://b/show/ws'),
                                   ('wss://a/ws', 'wss://b/ws', 'wss://b/ws'), ('wss://a/ws', 'http://b/', None),
                                   ('ws://a/ws', '', None), ('ws://a/ws', 'b', None), ('ws://a/ws', 'file:///b', None)):
            self.assertEqual(brume.address.going_on(here, go_to), there, (here, go_to))

    def test_a_lost_server_is_given_up_after_a_while(self):
        server = self.serve()
        with brume.connect(server.url, size=(96, 64), reconnect=0) as view:
            server.stop(kill=True)
            with self.assertRaisesRegex(brume.BrumeError, 'no connection|lost'):
                view.frame(after=10 ** 9)

    def test_the_socket_is_beside_the_page_below_whatever_prefix(self):
        for page in ('https://host/clouds/brume', 'https://host/clouds/brume/', 'https://host/clouds/brume/embed.html',
                     'wss://host/clouds/brume/ws'):
            self.assertEqual(brume.address.socket_address(page), 'wss://host/clouds/brume/ws')

    def test_nobody_there_and_no_address(self):
        with self.assertRaisesRegex(brume.BrumeError, 'no connection to ws://127.0.0.1:1/ws'):
            brume.connect('http://127.0.0.1:1')
        with self.assertRaisesRegex(brume.BrumeError, 'is no address'):
            brume.connect('ftp://somewhere')

    def test_tokens_and_roles(self):
        with tempfile.TemporaryDirectory() as folder:
            key = pathlib.Path(folder) / 'key'
            key.write_bytes(os.urandom(32))
            key.chmod(0o600)
            server = self.serve('--token-key', key)
            made = subprocess.run([program, '--token-key', key, '--make-token', 'viewer'], check=True, text=True,
                                  stdout=subprocess.PIPE).stdout.strip()
            with self.assertRaisesRegex(brume.BrumeError, 'a token is needed'):
                brume.connect(server.url)
            with brume.connect(server.url, token=made, size=(96, 64)) as view:
                view.frame()
                with self.assertRaisesRegex(brume.BrumeError, 'it takes controller') as caught:
                    view.pause()
                self.assertEqual(caught.exception.code, 'forbidden')

    def test_another_scene_and_a_cloud_of_ones_own(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        server = self.serve('--cloud-dir', folder.name + '/clouds')
        with brume.connect(server.url, size=(96, 64), timeout=PATIENCE) as view:
            self.assertIn('tubes', view.scenes)
            before = view.frame(timeout=COLD)
            view.show_scene('tubes')
            self.assertEqual(view.scene, 'tubes')
            self.assertNotEqual(view.frame(timeout=COLD).position, before.position)
            head = 'ply\nformat ascii 1.0\nelement vertex 2\n' + ''.join(
                f'property float {name}\n' for name in ('x', 'y', 'z', 'scale', 'sigma_t')) + 'end_header\n'
            path = pathlib.Path(folder.name) / 'two.ply'
            path.write_text(head + '2 0 0 4 30\n4 0 0 4 30\n')
            view.show_cloud(path, 'two')
            self.assertEqual(view.scene, 'two')
            view.show_cloud((head + '2 0 0 4 30\n9 0 0 4 30\n').encode(), 'two')  # the same name, another camera
            frame = view.frame(timeout=COLD)
            state = view.state
            self.assertEqual(state.particles, 2)
            self.assertLess(state.box[0][0], 2)
            self.assertGreater(state.box[1][0], 9)
            self.assertGreater(numpy.std(frame.array()), 2, 'they are seen')
            for line, act in (('no scene of that name', lambda: view.show_scene('nowhere')),
                              ('bad.ply', lambda: view.show_cloud(b'no points', 'bad'))):
                with self.assertRaisesRegex(brume.BrumeError, line):
                    act()

    def test_frames_tell_their_measured_error(self):
        with brume.connect(self.serve('--measure-error', '1').url, size=(160, 96), timeout=PATIENCE) as view:
            self.assertAlmostEqual(view.state.promised, 0.005)
            measured = next(frame.measured for frame in view.frames(10_000) if frame.measured)
            self.assertTrue(0 < measured.low < measured.error < measured.high < 1, measured)
        with brume.connect(self.serve('--measure-error', '0', '--method', 'slabs').url, size=(160, 96)) as view:
            self.assertIsNone(view.frame().measured)
            self.assertIsNone(view.state.promised)

    def test_a_full_server_says_so(self):
        server = self.serve('--max-viewers', '1')
        with brume.connect(server.url, size=(96, 64)):
            with self.assertRaises(brume.BrumeError) as caught:
                brume.connect(server.url, size=(96, 64))
            self.assertEqual(caught.exception.code, 'full')


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
