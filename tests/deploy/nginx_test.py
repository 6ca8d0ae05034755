"""nginx with our configuration, in front of a real server."""
import pathlib
import signal
import tempfile
import unittest

from behind import Behind, open_socket
from support import DEPLOY, PROGRAMS, Part, free_ports, get, until

# What Debian's nginx.conf has around the files of conf.d, in one folder and without a service.
MAIN = '''
daemon off;
pid {0}/pid;
error_log stderr warn;
events {{ worker_connections 256; }}
http {{
    access_log off;
    client_body_temp_path {0}/body;
    proxy_temp_path {0}/proxy;
    fastcgi_temp_path {0}/f;
    uwsgi_temp_path {0}/u;
    scgi_temp_path {0}/s;
    {1}
}}
'''


def start_nginx(folder, text):
    """nginx with that text in its http { }."""
    folder = pathlib.Path(folder)
    (folder / 'brume.location').write_text((DEPLOY / 'nginx/brume.location').read_text())
    (folder / 'nginx.conf').write_text(MAIN.format(folder, text))
    return Part('nginx', '-e', 'stderr', '-p', folder, '-c', folder / 'nginx.conf')


class Nginx(Behind, unittest.TestCase):
    @classmethod
    def start_proxy(cls, folder):
        text = (DEPLOY / 'nginx/brume.conf').read_text()
        for given, ours in (('127.0.0.1:8080', f'127.0.0.1:{cls.server_port}'), ('listen 80;', f'listen {cls.port};'),
                            ('listen [::]:80;', f'listen [::1]:{cls.port};'),
                            ('/var/log/nginx', folder)):
            assert given in text, given
            text = text.replace(given, ours)
        return start_nginx(folder, text)

    def test_its_log_has_no_token(self):
        get(f'{self.url}/snapshot.jpg?w=64&h=36&token=secret')
        log = pathlib.Path(self.folder.name) / 'brume.log'
        until('it is told', lambda: '/snapshot.jpg 200' in log.read_text())
        self.assertNotIn('secret', log.read_text())


class Bare(unittest.TestCase):
    """proxy_pass with nothing besides: what the server says of it."""

    def test_the_server_names_the_fault_in_one_line(self):
        folder = tempfile.TemporaryDirectory(prefix='brume-')
        self.addCleanup(folder.cleanup)
        port, server_port = free_ports(2)
        server = Part(PROGRAMS / 'brume-server', '--port', server_port, '--scene', 'cloud', '--ahead', 'off')
        self.addCleanup(server.stop, signal.SIGKILL)
        server.says('listening on http://')
        bare = f'server {{ listen {port}; location / {{ proxy_pass http://127.0.0.1:{server_port}; }} }}'
        proxy = start_nginx(folder.name, bare)
        self.addCleanup(proxy.stop)
        until('the proxy answers', lambda: get(f'http://127.0.0.1:{port}/healthz')[0] == 200)
        peer, answer = open_socket(port)
        peer.close()
        self.assertIn(b' 403 ', answer.split(b'\r\n')[0], 'the Host header is another')
        server.says('127.0.0.1: the proxy in front of this server does not pass WebSockets on: see docs/deploy.md')


if __name__ == '__main__':
    unittest.main()
