#!/usr/bin/env python3
"""How calls of the Python package wait: in threads, in event loops, until interrupted, closed, or left by the server.
python_waiting.py SERVER PACKAGE. Exit status 77: a package of the distribution is missing."""
import asyncio
import gc
import os
import signal
import socket
import subprocess
import sys
import textwrap
import threading
import time
import unittest

from python_server import PATIENCE, Server, Serving, brume, package, program

SIZE = (96, 64)


def threads():
    return [one for one in threading.enumerate() if one.name == 'brume']


class Waiting(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server(program)
        with brume.connect(cls.server.url, size=SIZE, timeout=4 * PATIENCE) as view:
            view.frame()  # what is compiled now delays no test

    @classmethod
    def tearDownClass(cls):
        assert cls.server.stop() == 0, 'the server survived all of it'

    def connect(self, **options):
        view = brume.connect(self.server.url, size=SIZE, timeout=PATIENCE, **options)
        self.addCleanup(view.close)
        return view

    def connect_async(self, **options):
        return brume.connect_async(self.server.url, size=SIZE, timeout=PATIENCE, **options)

    # ---- event loops ----

    def test_an_event_loop_gets_pictures_and_gives_commands(self):
        async def main():
            async with self.connect_async() as view:
                view.look(position=(3, 6, 26), target=(0, 0, 0))
                ticks = []
                async for frame in view.frames(4):
                    self.assertEqual(frame.position, (3, 6, 26))
                    ticks.append(frame.tick)
                self.assertEqual(ticks, sorted(set(ticks)))
                await view.pause()
                frame = await view.frame()
                self.assertEqual(frame.hash, view.state.hash)
                await view.push((0, 0, 26), (0, 0, -1), strength=5)
                await view.move((0, 1, 0))
                await view.add('fog', radius=3)
                await view.remove('fog', len(view.state.lists['fog']) - 1)
                self.assertNotEqual((await view.frame(after=frame.tick + 5)).hash, frame.hash)
                await view.restart()
                await view.resume()
                with self.assertRaisesRegex(brume.BrumeError, 'exposure must be') as caught:
                    await view.set('render.exposure', -1)
                self.assertEqual(caught.exception.code, 'out_of_range')
                with self.assertRaisesRegex(brume.BrumeError, 'no scene of that name'):
                    await view.show_scene('nowhere')
                with self.assertRaisesRegex(TimeoutError, 'no picture in 0.2 s'):
                    await view.frame(after=10 ** 9, timeout=0.2)
            with self.assertRaisesRegex(brume.BrumeError, 'closed'):
                await view.frame()
            view = await self.connect_async()
            await view.frame()
            await view.close()
            await view.close()
        asyncio.run(main())
        self.assertEqual(threads(), [])

    def test_other_tasks_run_while_one_waits_and_a_cancelled_one_waits_no_longer(self):
        async def main():
            turns = 0

            async def turn():
                nonlocal turns
                while True:
                    turns += 1
                    await asyncio.sleep(0)
            async with self.connect_async() as view, self.connect_async() as other:
                turning = asyncio.ensure_future(turn())
                one, two = await asyncio.gather(view.frame(), other.frame())
                self.assertGreater(turns, 10)
                turning.cancel()
                waits = asyncio.ensure_future(view.frame(after=10 ** 9))
                with self.assertRaises(asyncio.TimeoutError):
                    await asyncio.wait_for(waits, 0.2)
                self.assertEqual(view._link.watchers, set())
                order = asyncio.ensure_future(view.set('render.exposure', 1))
                await asyncio.sleep(0)
                order.cancel()
                await asyncio.gather(order, return_exceptions=True)
                self.assertEqual(view._link._awaited, set(), 'nobody waits for its answer')
                self.assertGreater((await view.frame()).tick, max(one.tick, two.tick))
        asyncio.run(main())

    def test_the_other_calls_work_in_an_event_loop_as_in_a_notebook(self):
        async def main():
            with brume.connect(self.server.url, size=SIZE, timeout=PATIENCE) as view:
                view.set('render.exposure', view.state.settings['render.exposure'])
                return view.frame().width
        self.assertEqual(asyncio.run(main()), SIZE[0])

    def test_a_viewer_outlives_the_loop_that_made_it(self):
        view = asyncio.run(self.connect_async()._begin())
        self.assertEqual(asyncio.run(view.frame()).width, SIZE[0])
        asyncio.run(view.close())

    def test_nobody_there_is_told_to_an_event_loop(self):
        async def main():
            with self.assertRaisesRegex(brume.BrumeError, 'no connection to ws://127.0.0.1:1/ws'):
                async with brume.connect_async('http://127.0.0.1:1'):
                    pass
        asyncio.run(main())

    def test_who_accepts_and_never_answers_is_left_at_once(self):
        with socket.create_server(('127.0.0.1', 0)) as silent:
            url = f'http://127.0.0.1:{silent.getsockname()[1]}'
            begin = time.monotonic()
            with self.assertRaisesRegex(TimeoutError, 'no welcome from ws://127.0.0.1:.* in 0.5 s'):
                brume.connect(url, timeout=0.5)
            self.assertLess(time.monotonic() - begin, 4, 'not after the handshake has failed')

            async def main():
                with self.assertRaisesRegex(TimeoutError, 'no welcome'):
                    await brume.connect_async(url, timeout=0.5)
            asyncio.run(main())

    # ---- threads ----

    def test_threads_share_a_viewer(self):
        view = self.connect()
        view.frame()
        faults = []

        def work(number):
            try:
                for i in range(6):
                    if number % 2:
                        view.push((0, 0, 26), (0, 0, -1), strength=0.1)
                        view.look(position=(number, 6, 26 + i))
                    else:
                        self.assertEqual(view.frame().width, SIZE[0])
            except BaseException as fault:
                faults.append(fault)
        workers = [threading.Thread(target=work, args=(number,)) for number in range(6)]
        for one in workers:
            one.start()
        for one in workers:
            one.join(4 * PATIENCE)
        self.assertEqual(faults, [])
        self.assertFalse(any(one.is_alive() for one in workers))

    def test_closing_ends_calls_that_wait_in_other_threads_and_later_ones(self):
        view = self.connect()
        view.frame()
        said = []

        def wait():
            try:
                view.frame(after=10 ** 9)
            except brume.BrumeError as error:
                said.append(str(error))
        waiting = threading.Thread(target=wait)
        waiting.start()
        time.sleep(0.1)
        begin = time.monotonic()
        view.close()
        waiting.join(PATIENCE)
        self.assertLess(time.monotonic() - begin, 5)
        self.assertEqual(said, ['the viewer is closed'])
        for act in (view.frame, view.pause, lambda: view.look(position=(0, 0, 9)), lambda: view.state, view.particles,
                    lambda: next(view.frames()), lambda: view.show_scene('nowhere'), lambda: view.scene):
            with self.assertRaisesRegex(brume.BrumeError, 'the viewer is closed|gets pictures'):
                act()
        self.assertFalse(view.connected)
        self.assertIn('closed', view._repr_mimebundle_()['text/plain'])
        view.close()

    def test_a_viewer_that_nobody_has_any_more_leaves(self):
        view = brume.connect(self.server.url, size=SIZE, timeout=PATIENCE)
        view.frame()
        (thread,) = threads()
        del view
        gc.collect()
        thread.join(PATIENCE)
        self.assertFalse(thread.is_alive(), 'its connection is still there')

    def test_a_process_that_was_forked_is_told_to_connect(self):
        view = self.connect()
        view.frame()
        child = os.fork()
        if child == 0:
            try:
                view.frame()
            except brume.BrumeError as error:
                os._exit(0 if 'connect() in this one, too' in str(error) else 2)
            finally:
                os._exit(3)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        self.assertEqual(view.frame().width, SIZE[0])

    def test_a_fault_of_the_connection_is_told_and_nothing_waits_for_it(self):
        view = self.connect()
        view.frame()
        view._link._receive = None
        with self.assertRaisesRegex(brume.BrumeError, 'a fault of this package'):
            view.frame(after=10 ** 9)

    # ---- Ctrl-C ----

    def interrupted(self, program_text):
        """What a program says that is interrupted once it has printed a line, and how long it takes then, in s."""
        text = f'import asyncio, sys\nsys.path.insert(0, {package!r})\nimport brume\n' + textwrap.dedent(program_text)
        child = subprocess.Popen([sys.executable, '-c', text, self.server.url], stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, text=True)
        self.addCleanup(child.kill)
        self.assertEqual(child.stdout.readline(), 'waits\n')
        time.sleep(0.3)
        begin = time.monotonic()
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=PATIENCE)
        return out, err, time.monotonic() - begin

    def test_a_call_that_waits_can_be_interrupted(self):
        out, err, seconds = self.interrupted('''
            with brume.connect(sys.argv[1], size=(96, 64)) as view:
                view.frame()
                print('waits', flush=True)
                try:
                    view.frame(after=10 ** 9, timeout=1000)
                except KeyboardInterrupt:
                    print(view.frame().width)
                view.frame(after=10 ** 9, timeout=2)
            ''')
        self.assertEqual(out, '96\n')
        self.assertIn('TimeoutError: no picture in 2 s', err)
        out, err, seconds = self.interrupted('''
            view = brume.connect(sys.argv[1], size=(96, 64))  # nobody closes it
            view.frame()
            print('waits', flush=True)
            view.frame(after=10 ** 9, timeout=1000)
            ''')
        self.assertEqual(err.splitlines()[-1], 'KeyboardInterrupt')
        self.assertLess(seconds, 5)

    def test_an_event_loop_that_waits_can_be_interrupted(self):
        out, err, seconds = self.interrupted('''
            async def main():
                async with brume.connect_async(sys.argv[1], size=(96, 64)) as view:
                    await view.frame()
                    print('waits', flush=True)
                    await view.frame(after=10 ** 9, timeout=1000)
            asyncio.run(main())
            ''')
        self.assertEqual(err.splitlines()[-1], 'KeyboardInterrupt')
        self.assertNotIn('never retrieved', err)
        self.assertLess(seconds, 5)


class Gone(Serving):
    """The server goes away, and comes back."""

    def test_calls_say_so_while_it_is_away_and_work_when_it_is_back(self):
        server = self.serve()
        with brume.connect(server.url, size=SIZE, timeout=PATIENCE) as view:
            view.look(position=(0, 9, 20))
            view.frame(timeout=4 * PATIENCE)
            server.stop(kill=True)
            with view._link.changed:
                self.assertTrue(view._link.changed.wait_for(lambda: not view.connected, PATIENCE))
            for act in (lambda: view.state, lambda: view.set('render.exposure', 1), view.restart, lambda: view.scene):
                with self.assertRaisesRegex(brume.BrumeError, 'not connected.*(lost|no connection)'):
                    act()
            with self.assertRaisesRegex(TimeoutError, 'no picture in 0.2 s: not connected at present .*lost|no conn'):
                view.frame(after=10 ** 9, timeout=0.2)
            view.look(position=(0, 9, 22))  # it is shown when the server is back
            again = self.serve('--port', server.port)
            self.assertEqual(view.frame(timeout=4 * PATIENCE).position, (0, 9, 22))
            self.assertTrue(view.connected)
            again.stop(kill=True)
            begin = time.monotonic()
            view.close()  # while it tries to connect
            self.assertLess(time.monotonic() - begin, 3)
        self.assertEqual(threads(), [])

    def test_an_event_loop_hears_that_it_stays_away(self):
        server = self.serve()

        async def main():
            async with brume.connect_async(server.url, size=SIZE, timeout=PATIENCE, reconnect=0) as view:
                await view.frame(timeout=4 * PATIENCE)
                asyncio.get_running_loop().call_later(0.2, server.stop, True)
                with self.assertRaisesRegex(brume.BrumeError, 'lost|no connection'):
                    async for _ in view.frames():
                        pass
        asyncio.run(main())


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
