#!/usr/bin/env python3
"""What a notebook gets from the Python package, without a notebook: python_notebook.py SERVER PACKAGE. The browser's
half of the widget is in tests/browser/notebook.mjs. Exit status 77: a package of the distribution is missing."""
import asyncio
import base64
import pathlib
import sys
import types
import unittest
import unittest.mock

from python_server import COLD, Serving, brume

try:
    import traitlets
except ImportError:
    traitlets = None


class Notebook(Serving):
    def test_frames_and_viewers_show_a_picture(self):
        server = self.serve()
        with brume.connect(server.url, size=(96, 64), timeout=COLD, lossless=True) as view:
            frame = view.frame()
            self.assertTrue(frame._repr_jpeg_().startswith(b'\xff\xd8\xff'))
            self.assertIsNone(frame._repr_png_())
            shown = view._repr_mimebundle_(include=None, exclude=None)
            self.assertTrue(base64.b64decode(shown['image/jpeg']).startswith(b'\xff\xd8\xff'))
            self.assertIsNot(view._last, frame, 'a picture of now')
            self.assertIn(server.url, repr(view))
            view.pause()
            while not frame.lossless:
                frame = view.frame()
            self.assertTrue(frame._repr_png_().startswith(b'\x89PNG'))
            self.assertIsNone(frame._repr_jpeg_())
            self.assertTrue(base64.b64decode(view._repr_mimebundle_()['image/png']).startswith(b'\x89PNG'))

        async def main():
            async with brume.connect_async(server.url, size=(96, 64), timeout=COLD) as view:
                await view.frame()
                return view._repr_mimebundle_()
        self.assertIn('image/jpeg', asyncio.run(main()))

    def test_without_anywidget_there_is_a_frame_of_the_page(self):
        with unittest.mock.patch.dict(sys.modules, {'anywidget': None}):
            shown = brume.show('ws://there:8080/ws', position=(0, 6, 26), target=(0, 0, 0), controls='look',
                               size=(640, 360), token='a"b', height='60vh')
        self.assertEqual(shown.url, 'http://there:8080/embed.html?position=0,6,26&target=0,0,0&controls=look&'
                                    'size=640x360&draw=auto#token=a%22b')
        self.assertRegex(shown._repr_html_(), '^<iframe src="http://there:8080/embed.html.position=0,6,26&amp;target')
        self.assertIn('height: 60vh', shown._repr_html_())

    def test_what_is_wrong_is_said(self):
        for line, options in (('no controls', {'controls': 'fly'}), ('position has 2', {'position': (1, 2)})):
            with self.assertRaisesRegex(brume.BrumeError, line):
                brume.show('http://there', **options)
        with self.assertRaisesRegex(brume.BrumeError, 'is no address'):
            brume.show('ftp://there')

    def test_a_viewer_is_shown_by_its_server_and_token(self):
        server = self.serve()
        with brume.connect(server.url, token='t', size=(96, 64), timeout=COLD) as view:
            with unittest.mock.patch.dict(sys.modules, {'anywidget': None}):
                self.assertTrue(brume.show(view).url.startswith(f'{server.url}/embed.html?'))
                self.assertTrue(brume.show(view).url.endswith('#token=t'))

    @unittest.skipUnless(traitlets, 'python3-traitlets is missing: ./dev test integration installs it')
    def test_with_anywidget_there_is_a_widget_with_traits(self):
        class AnyWidget(traitlets.HasTraits):
            """Stands in for anywidget's, which Debian does not have."""
            hold_sync = traitlets.HasTraits.hold_trait_notifications
        anywidget = types.ModuleType('anywidget')
        anywidget.AnyWidget = AnyWidget
        with unittest.mock.patch.dict(sys.modules, {'anywidget': anywidget}):
            widget = brume.show('http://there', position=(0, 6, 26), size=(640, 360), height=200)
        synced = widget.traits(sync=True)
        self.assertEqual(set(synced), {'src', 'token', 'position', 'target', 'fov', 'controls', 'draw', 'size', 'width',
                                       'height', 'settings', 'state', 'tick', 'note'})
        self.assertEqual((widget.src, widget.position, widget.target, widget.size, widget.height),
                         ('http://there/', [0, 6, 26], None, '640x360', '200px'))
        heard = []
        widget.observe(heard.append, ['position', 'settings'])
        widget.look(position=(1, 2, 3), target=(0, 0, 0))
        widget.settings = {'render.exposure': 1.0, 'medium.albedo': [1, 1, 1]}
        widget.set('render.exposure', 2)
        self.assertEqual([one['new'] for one in heard][-1], {'render.exposure': 2, 'medium.albedo': [1, 1, 1]})
        self.assertEqual((widget.position, widget.target), ([1, 2, 3], [0, 0, 0]))
        for name, value in (('position', [1, 2]), ('controls', 'fly'), ('fov', 'wide')):
            with self.assertRaises(traitlets.TraitError):
                setattr(widget, name, value)
        self.assertTrue(pathlib.Path(type(widget)._esm).is_file())


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
