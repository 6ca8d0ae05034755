"""Apache with our configuration, a provider of OpenID Connect, and a real server: who signs in gets tokens, again and
again. The page of it, in a real Chromium, is signed_in.mjs."""
import asyncio
import base64
import http.client
import http.cookiejar
import json
import os
import pathlib
import shutil
import signal
import sys
import tempfile
import time
import unittest
import urllib.error
import urllib.request

from behind import HELLO, open_socket, say_hello
from support import DEPLOY, PROGRAMS, ROOT, Part, free_ports, get, run, until

HERE = pathlib.Path(__file__).resolve().parent
POSE = (ROOT / 'protocol/examples/pose.bin').read_bytes()
PAGE = {'Accept': 'text/html'}
ASKED_AGAIN_S = 1.2  # more than OIDCUserInfoRefreshInterval here
SIGN_IN = b'Nobody is signed in here: load the page again to sign in.'

# What Debian's apache2.conf and a2enmod have around the files of sites-enabled.
MODULES = ('mpm_event authn_core authz_core authz_user auth_openidc alias cgid env headers proxy proxy_http').split()
MAIN = '''
ServerRoot {0}
ServerName 127.0.0.1
PidFile {0}/pid
DefaultRuntimeDir {0}
ScriptSock {0}/cgid
{1}
Define APACHE_LOG_DIR {0}
Listen 127.0.0.1:{2}
ErrorLog {0}/main.log
<Directory />
    Require all denied
</Directory>
{3}
'''

# In place of brume-server where tokens are to last for less than it takes a clock to be wrong.
MAKER = '''#!{0}
import base64, hashlib, hmac, json, os, sys, time
if not os.path.exists('{1}/short'):
    os.execv('{2}', ['{2}', *sys.argv[1:]])
given = dict(word.split('=', 1) for word in sys.argv if '=' in word)
encode = lambda data: base64.urlsafe_b64encode(data).rstrip(b'=')
exp = int(time.time()) - 30 + int(open('{1}/short').read())
said = encode(json.dumps({{'exp': exp, 'name': given['--token-name'],
                           'role': sys.argv[sys.argv.index('--make-token') + 1]}}).encode())
print((said + b'.' + encode(hmac.digest(open(given['--token-key'], 'rb').read(), said, 'sha256'))).decode())
'''


class Person:
    """Somebody's browser: keeps cookies and follows redirects."""

    def __init__(self, url, logs):
        self.url, self.logs, self.cookies = url, logs, http.cookiejar.CookieJar()
        self.opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(self.cookies))

    def get(self, path, headers=()):
        """(status, headers, body)"""
        try:
            with self.opener.open(urllib.request.Request(self.url + path, headers=dict(headers)), timeout=20) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()

    def sign_in(self):
        status, _, body = self.get('/', PAGE)
        assert status == 200 and b'<brume-view' in body, body
        return self

    def token(self, headers=()):
        status, got, body = self.get('/token', headers)
        assert status == 200, (status, body, *(log.read_text()[-1000:] for log in self.logs.glob('*.log')))
        for name, value in (('Content-Type', 'text/plain; charset=utf-8'), ('Cache-Control', 'no-store'),
                            ('X-Content-Type-Options', 'nosniff'), ('Cross-Origin-Resource-Policy', 'same-origin')):
            assert got[name] == value, got
        return body.decode().strip()

    def cookie(self):
        return '; '.join(f'{cookie.name}={cookie.value}' for cookie in self.cookies)


def claims(token):
    said = token.split('.')[0]
    return json.loads(base64.urlsafe_b64decode(said + '=' * (-len(said) % 4)))


async def picture(port, token, cookie):
    """The first message with a JPEG, of a WebSocket through the proxy."""
    import websockets
    headers = 'additional_headers' if int(websockets.__version__.split('.')[0]) >= 14 else 'extra_headers'
    async with websockets.connect(f'ws://127.0.0.1:{port}/ws?token={token}', subprotocols=['brume.v1'], max_size=None,
                                  origin=f'http://127.0.0.1:{port}', **{headers: {'Cookie': cookie}}) as socket:
        await socket.send(HELLO)
        await socket.send(POSE)
        while True:
            message = await asyncio.wait_for(socket.recv(), 60)
            if b'\xff\xd8\xff' in message:
                return message


class SignedIn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix='brume-')
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        cls.port, cls.server_port, cls.provider_port = free_ports(3)
        cls.url, cls.issuer = f'http://127.0.0.1:{cls.port}', f'http://localhost:{cls.provider_port}'
        cls.key = cls.path / 'token.key'
        cls.key.write_bytes(os.urandom(32))
        cls.key.chmod(0o600)
        cls.comes(preferred_username='ann', groups=[])
        cls.provider = Part('node', HERE / 'provider.mjs', cls.provider_port, cls.path / 'person.json')
        cls.addClassCleanup(cls.provider.stop)
        cls.server = Part(PROGRAMS / 'brume-server', '--port', cls.server_port, '--scene', 'cloud', '--ahead', 'off',
                          '--token-key', cls.key, '--trusted-proxy', '127.0.0.1')
        cls.addClassCleanup(cls.server.stop, signal.SIGKILL)
        cls.provider.says('issuer')
        cls.server.says('listening on http://')
        cls.apache = cls.start_apache()
        cls.addClassCleanup(cls.apache.stop)
        until('Apache answers', cls.answers)

    @classmethod
    def answers(cls):
        assert cls.apache.process.poll() is None, cls.apache.said()
        return get(f'{cls.url}/healthz')[0] == 200

    @classmethod
    def start_apache(cls):
        folder = cls.path
        shutil.copy(DEPLOY / 'apache/brume-token', folder)
        (folder / 'maker').write_text(MAKER.format(sys.executable, folder, PROGRAMS / 'brume-server'))
        (folder / 'maker').chmod(0o755)
        (folder / 'secrets.conf').write_text('OIDCClientSecret secret\nOIDCCryptoPassphrase phrase\n')
        (folder / 'cache').mkdir()
        text = (DEPLOY / 'apache/brume.conf').read_text()
        for given, ours in (('*:443', f'127.0.0.1:{cls.port}'), ('SSLEngine on\n', '\n'),
                            ('SSLCertificateFile /etc/ssl/clouds.example.crt\n', '\n'),
                            ('SSLCertificateKeyFile /etc/ssl/private/clouds.example.key\n', '\n'),
                            ('https://login.example', cls.issuer),
                            ('OIDCDefaultLoggedOutURL https://clouds.example', f'OIDCDefaultLoggedOutURL {cls.url}'),
                            ('/etc/apache2/brume-secrets.conf', f'{folder}/secrets.conf'),
                            ('/var/cache/apache2/mod_auth_openidc/cache', f'{folder}/cache'),
                            ('OIDCUserInfoRefreshInterval 60', 'OIDCUserInfoRefreshInterval 1'),
                            ('/usr/local/lib/brume/brume-token', f'{folder}/brume-token'),
                            ('SetEnv BRUME_TOKEN_KEY /etc/brume/token.key',
                             f'SetEnv BRUME_TOKEN_KEY {cls.key}\nSetEnv BRUME_TOKEN_SERVER {folder}/maker'),
                            ('http://127.0.0.1:8080/', f'http://127.0.0.1:{cls.server_port}/')):
            assert given in text, given
            text = text.replace(given, ours)
        modules = [f'LoadModule {name}_module /usr/lib/apache2/modules/mod_{name}.so' for name in MODULES]
        if os.geteuid() == 0:  # Apache's processes do not stay root
            modules += ['User www-data', 'Group www-data']
            for path in (folder, *folder.iterdir()):
                shutil.chown(path, 'www-data', 'www-data')
        (folder / 'apache.conf').write_text(MAIN.format(folder, '\n'.join(modules), cls.port, text))
        return Part('apache2', '-D', 'FOREGROUND', '-f', folder / 'apache.conf')

    @classmethod
    def comes(cls, **person):
        """Who signs in next, and what the provider says of all who have."""
        there = cls.path / 'person.json'
        there.with_suffix('.new').write_text(json.dumps(person))
        there.with_suffix('.new').replace(there)

    def setUp(self):
        self.comes(preferred_username='ann', groups=[])

    def test_who_signs_in_sees_a_picture(self):
        ann = Person(self.url, self.path).sign_in()
        token = ann.token()
        self.assertEqual({**claims(token), 'exp': None}, {'exp': None, 'name': 'ann', 'role': 'viewer'})
        self.assertAlmostEqual(claims(token)['exp'], time.time() + 3600, delta=60)
        self.assertTrue(asyncio.run(picture(self.port, token, ann.cookie())))
        self.server.says(r'viewer \d+.*ann')

    def test_nobody_else_gets_anything(self):
        stranger = Person(self.url, self.path)
        told = '{"sub":"x","groups":["brume-operators"]}'
        forged = {'OIDC-userinfo-json': told, 'OIDC_userinfo_json': told, 'Remote-User': 'ann',
                  'Cookie': 'mod_auth_openidc_session=x'}
        for path in ('/token', '/token/', '/ws', '/snapshot.jpg', '/scene', '/assets/none.js'):
            for headers in ({}, {'Accept': '*/*'}, forged):
                self.assertEqual(stranger.get(path, headers)[::2], (401, SIGN_IN), path)
        self.assertEqual(stranger.get('/token', PAGE)[::2], (401, SIGN_IN), 'no redirect either')

    def test_the_role_is_that_of_the_group_and_goes_with_it(self):
        self.comes(preferred_username='ann', groups=['staff', 'brume-operators'])
        ann = Person(self.url, self.path).sign_in()
        first = ann.token()
        self.assertEqual(claims(first)['role'], 'operator')
        self.assertEqual(ann.get('/viewers', {'Authorization': f'Bearer {first}'})[0], 200)
        self.comes(preferred_username='ann', groups='brume-controllers')
        time.sleep(ASKED_AGAIN_S)
        self.assertEqual(claims(ann.token())['role'], 'controller')
        self.comes(preferred_username='ann', groups=['a,brume-operators', 'brume-operators=operator', '', {'a': 1}])
        time.sleep(ASKED_AGAIN_S)
        self.assertEqual(claims(ann.token())['role'], 'viewer')

    def test_no_header_of_the_visitors_makes_a_role(self):
        ann = Person(self.url, self.path).sign_in()
        told = '{"sub":"x","preferred_username":"x","groups":["brume-operators"]}'
        forged = {name: told for name in ('OIDC_userinfo_json', 'OIDC-userinfo-json', 'HTTP_OIDC_userinfo_json')}
        forged |= {name: 'brume-operators' for name in ('OIDC_CLAIM_groups', 'OIDC-CLAIM-groups', 'X-Forwarded-Groups')}
        forged |= {'X-Forwarded-Preferred-Username': 'x', 'Remote-User': 'x', 'Brume-Token-Roles': '=operator'}
        said = claims(ann.token(forged))
        self.assertEqual((said['name'], said['role']), ('ann', 'viewer'))

    def test_whom_the_provider_no_longer_knows_is_signed_out(self):
        ann = Person(self.url, self.path).sign_in()
        ann.token()
        refreshed = self.provider.said().count('refresh')
        self.comes(gone=True)
        self.assertEqual(ann.get('/token')[::2], (401, SIGN_IN))
        self.assertIn(': 400', self.provider.said().splitlines()[refreshed + 1], 'by a refresh that is refused')
        self.comes(preferred_username='ann', groups=[])
        for path in ('/token', '/ws', '/snapshot.jpg'):
            self.assertEqual(ann.get(path)[::2], (401, SIGN_IN), path)

    def test_who_signs_out_is_out(self):
        ann = Person(self.url, self.path).sign_in()
        cookie = ann.cookie()
        self.assertEqual(ann.get('/signed-in?logout=', PAGE)[::2], (401, SIGN_IN))
        self.assertEqual(get(f'{self.url}/token', {'Cookie': cookie})[0], 401, 'with the old cookie, too')

    def test_who_is_in_no_group_is_told_so(self):
        ann = {'OIDC_userinfo_json': json.dumps({'sub': '1', 'preferred_username': 'ann', 'groups': ['x']}),
               'BRUME_TOKEN_SERVER': str(PROGRAMS / 'brume-server'), 'BRUME_TOKEN_KEY': str(self.key)}
        said = lambda **more: run(DEPLOY / 'apache/brume-token', env=os.environ | ann | more)
        self.assertIn('Status: 200', said(BRUME_TOKEN_ROLES='x=viewer'))
        self.assertIn('ann is signed in, but in no group', said(BRUME_TOKEN_ROLES='y=viewer'))
        for wrong in ({'OIDC_userinfo_json': ''}, {'OIDC_userinfo_json': '[]'}, {'BRUME_TOKEN_ROLES': 'viewer'},
                      {'BRUME_TOKEN_ROLES': '=king'}, {'BRUME_TOKEN_KEY': '/none'}, {'BRUME_TOKEN_SERVER': '/none'}):
            answer = said(**{'BRUME_TOKEN_ROLES': '=viewer'} | wrong)
            self.assertIn('Status: 500', answer)
            self.assertIn('brume-token: ', answer, 'for the log')

    def test_a_name_is_at_most_64_characters_of_ascii(self):
        for name, told in (('<script>alert(1)</script>', '<script>alert(1)</script>'), ('Zoë Müller', 'Zoe Muller'),
                           ('李小龙', '???'), ('--open "$(id)" %s\n', '--open "$(id)" %s'), ('x' * 300, 'x' * 64),
                           ('\u202eevil\r\nviewer 9', '?evil??viewer 9'), ('', 'a@b.example'), (7, 'a@b.example')):
            self.comes(preferred_username=name, email='a@b.example', groups=[])
            token = Person(self.url, self.path).sign_in().token()
            self.assertEqual(claims(token)['name'], told)
            self.assertNotEqual(get(f'http://127.0.0.1:{self.server_port}/snapshot.jpg?w=64&h=36',
                                    {'Authorization': f'Bearer {token}'})[0], 401, 'a good token')

    def test_a_session_outlives_a_reload_of_apache_and_the_browser(self):
        ann = Person(self.url, self.path).sign_in()
        ann.token()
        self.assertGreater(min(cookie.expires or 0 for cookie in ann.cookies), time.time() + 3600)
        begun = (self.path / 'main.log').read_text().count('resuming')
        self.apache.process.send_signal(signal.SIGUSR1)
        until('Apache is there again', lambda: (self.path / 'main.log').read_text().count('resuming') > begun)
        ann.token()

    def test_pictures_and_uploads_pass_at_once_and_the_log_has_the_visitors_address(self):
        self.comes(preferred_username='chief', groups=['brume-operators'])
        chief = Person(self.url, self.path).sign_in()
        cookie, token = chief.cookie(), chief.token()
        ours = {'Cookie': cookie, 'Authorization': f'Bearer {token}'}
        peer, answer = open_socket(self.port, f'/ws?token={token}', source_address=('127.0.0.77', 0),
                                   headers=(f'Cookie: {cookie}', 'X-Forwarded-For: 203.0.113.9'))
        with peer:
            self.assertIn(b' 101 ', answer.split(b'\r\n')[0])
            self.assertTrue(say_hello(peer))
            self.server.says(r'viewer \d+ \(chief\).* from 127\.0\.0\.77,')
        status, _, body = get(f'{self.url}/cloud?name=none', ours, method='POST', data=os.urandom(3 << 20))
        self.assertEqual((status, body[:14]), (422, b'none.ply:1: PL'), 'the server has read it')
        self.assertEqual(get(f'{self.url}/pause', ours, method='POST')[0], 200)
        self.addCleanup(get, f'{self.url}/resume', ours, method='POST')
        asked = http.client.HTTPConnection('127.0.0.1', self.port, timeout=20)
        self.addCleanup(asked.close)
        asked.request('GET', '/stream.mjpg?w=64&h=36', headers=ours)
        stream, got = asked.getresponse(), b''
        while b'\xff\xd9' not in got:  # although none follows
            part = stream.read1(65536)
            self.assertTrue(part, 'the stream goes on')
            got += part

    def test_no_log_has_a_token(self):
        ann = Person(self.url, self.path).sign_in()
        token = ann.token()
        ann.get(f'/snapshot.jpg?w=64&h=36&token={token}')
        until('it is told', lambda: 'GET /snapshot.jpg' in (self.path / 'brume.log').read_text())
        for log in self.path.glob('*.log'):
            self.assertNotIn(token[:20], log.read_text())
        self.assertNotIn(token[:20], self.server.said())

    def test_the_page_outlives_its_token(self):
        run('node', HERE / 'signed_in.mjs', self.url, self.issuer, self.path)


if __name__ == '__main__':
    unittest.main()
