"""Caddy with our configuration, in front of a real server."""
import pathlib
import unittest

from behind import Behind
from support import DEPLOY, Part, free_ports


class Caddy(Behind, unittest.TestCase):
    @classmethod
    def start_proxy(cls, folder):
        text = (DEPLOY / 'caddy/Caddyfile').read_text()
        admin, = free_ports(1)
        ours = f'http://127.0.0.1:{cls.port}, http://[::1]:{cls.port}'
        for given, there in (('127.0.0.1:8080', f'127.0.0.1:{cls.server_port}'),
                             ('\nhttp://clouds.example {', f'\n{ours} {{')):
            assert given in text, given
            text = text.replace(given, there)
        file = pathlib.Path(folder) / 'Caddyfile'
        file.write_text(f'{{\n\tadmin 127.0.0.1:{admin}\n\tdefault_bind 127.0.0.1 ::1\n}}\n{text}')
        return Part('caddy', 'run', '--config', file, '--adapter', 'caddyfile',
                    env={'HOME': folder, 'XDG_DATA_HOME': folder, 'XDG_CONFIG_HOME': folder})


if __name__ == '__main__':
    unittest.main()
