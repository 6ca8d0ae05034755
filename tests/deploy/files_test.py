"""The files of deploy/, each read by the program that it is for. No server runs."""
import json
import os
import pathlib
import re
import shutil
import tempfile
import unittest

from support import DEPLOY, PROGRAMS, ROOT, run

HERE = pathlib.Path(__file__).resolve().parent
PACKAGES = PROGRAMS.parent / 'packages'


class HaproxyAndNats(unittest.TestCase):
    def test_haproxy(self):
        """Names of the nodes are Docker's and lead nowhere here, which is a warning."""
        run('haproxy', '-c', '-f', DEPLOY / 'haproxy/haproxy.cfg', '-f', DEPLOY / 'haproxy/nodes.cfg')

    def test_nats(self):
        run('nats-server', '-t', '-c', DEPLOY / 'kubernetes/nats.conf', env={**os.environ, 'NATS_PASSWORD': 'secret'})


class Prometheus(unittest.TestCase):
    def test_configuration_and_rules(self):
        run('promtool', 'check', 'config', DEPLOY / 'prometheus/prometheus.yml')

    def test_what_alerts_fire(self):
        run('promtool', 'test', 'rules', HERE / 'alerts_test.yml')

    def test_every_alert_has_a_test(self):
        tests = (HERE / 'alerts_test.yml').read_text()
        for alert in re.findall(r'- alert: (\w+)', (DEPLOY / 'prometheus/alerts.yml').read_text()):
            self.assertRegex(tests, f'alertname(="|: ){alert}\\b')

    def test_targets_are_the_nodes_of_haproxy(self):
        targets = json.loads((DEPLOY / 'prometheus/targets.json').read_text())
        labels = [target['labels'] for target in targets if 'job' not in target['labels']]
        asked = {(label['instance'], label['__metrics_path__']) for label in labels}
        nodes = re.findall(r'^ *server (\w+)', (DEPLOY / 'haproxy/nodes.cfg').read_text(), re.M)
        self.assertEqual(asked, {(node, f'/node/{node}/metrics') for node in nodes})


class Container(unittest.TestCase):
    def test_start(self):
        """The server starts with a copy of the shaders, made once, that it can write."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            (path / 'compiled').mkdir()
            (path / 'compiled/shader').write_text('compiled')
            (path / 'brume-server').write_text('#!/bin/sh\ncat "$XDG_CACHE_HOME/shader"; echo " $*"; '
                                               'echo learnt >"$XDG_CACHE_HOME/shader"\n')
            (path / 'brume-server').chmod(0o755)
            environment = {'PATH': f'{path}:/usr/bin:/bin', 'COMPILED_SHADERS': str(path / 'compiled'),
                           'XDG_CACHE_HOME': str(path / 'cache')}
            for there in ('compiled', 'learnt\n'):
                said = run(DEPLOY / 'container/brume-start', '--scene', 'cloud', env=environment)
                self.assertEqual(said, f'{there} --listen 0.0.0.0 --scene cloud\n')
            self.assertEqual(os.listdir(path / 'cache'), ['shader'])


class Compose(unittest.TestCase):
    # Whom Docker has to let in, and nobody else.
    PORTS = {'one': {'brume': '8080'}, 'cluster': {'haproxy': '8080', 'prometheus': '9090', 'grafana': '3000'}}
    SERVERS = {'one': {'brume'}, 'cluster': {'n1', 'n2', 'n3', 'nats', 'haproxy', 'prometheus', 'grafana'}}

    def services(self, profile):
        compose = ['docker-compose', '-f', DEPLOY / 'compose.yaml', '--profile', profile]
        names = set(run(*compose, 'config', '--services').split())
        # Older ones list services of other profiles, too.
        self.assertLessEqual(self.SERVERS[profile], names)
        text = re.search(r'^services:\n((?: .*\n)+)', run(*compose, 'config'), re.M)[1]
        services = {}
        for name, body in re.findall(r'^  ([\w-]+):\n((?:    .*\n)+)', text, re.M):
            if name in self.SERVERS[profile]:
                services[name] = body
        self.assertEqual(set(services), self.SERVERS[profile])
        return services

    def test_contained(self):
        for profile, ports in self.PORTS.items():
            for name, body in self.services(profile).items():
                with self.subTest(name):
                    self.assertIn('    read_only: true\n', body)
                    self.assertRegex(body, r'    cap_drop:\n +- ALL\n')
                    self.assertIn('no-new-privileges:true', body)
                    self.assertEqual('    ports:' in body, name in ports)
                    if name in ports:
                        self.assertRegex(body, f'127\\.0\\.0\\.1:{ports[name]}:|host_ip: 127\\.0\\.0\\.1')
                    self.assertNotRegex(body, r'(?m)^ +- "?\d+:\d+')
                    self.assertTrue('    healthcheck:' in body or '    build:' in body, 'the image has one of its own')
                    self.assertRegex(body, r'(?m)^    image: [^:\s]+:[\w.-]+$')


class Kubernetes(unittest.TestCase):
    def test_builds_and_fits_the_schemas(self):
        manifests = run('kubectl', 'kustomize', DEPLOY / 'kubernetes')
        with tempfile.NamedTemporaryFile('w', suffix='.yaml') as file:
            file.write(manifests)
            file.flush()
            self.assertIn('10 objects, 0 mistakes', run('node', HERE / 'manifests.mjs', file.name))
        # Names of generated ConfigMaps have a hash: whoever uses one has the same.
        for name in ('brume', 'brume-nats'):
            full = re.search(f'kind: ConfigMap\nmetadata:\n  name: ({name}-[a-z0-9]+)\n', manifests)[1]
            self.assertRegex(manifests, f'configMap:\n +name: {full}\n')

    def test_only_what_kustomize_2_knows(self):
        """Debian 12 has kustomize 2.0.3 in its kubectl; this machine's may be newer."""
        text = (DEPLOY / 'kubernetes/kustomization.yaml').read_text()
        keys = set(re.findall(r'^(\w+):', text, re.M))
        self.assertEqual(keys, {'apiVersion', 'kind', 'resources', 'configMapGenerator'})

    def test_stopping_takes_less_than_the_grace_period(self):
        deployment = (DEPLOY / 'kubernetes/deployment.yaml').read_text()
        options = dict(re.findall(r'^([\w-]+) = (\d+)$', (DEPLOY / 'kubernetes/brume.toml').read_text(), re.M))
        seconds = int(re.search(r'terminationGracePeriodSeconds: (\d+)', deployment)[1])
        self.assertGreater(seconds * 1000, int(options['drain-time']) + int(options['grace']) + 1000)


class Options(unittest.TestCase):
    def test_files_are_read(self):
        with tempfile.TemporaryDirectory() as folder:
            key = pathlib.Path(folder) / 'token.key'
            key.write_bytes(bytes(32))
            key.chmod(0o600)
            for file in (DEPLOY / 'brume.toml', DEPLOY / 'kubernetes/brume.toml'):
                options = pathlib.Path(folder) / 'brume.toml'
                options.write_text(file.read_text().replace('/run/secrets/brume/token.key', str(key)))
                printed = run(PROGRAMS / 'brume-server', '--config', options, '--print-config')
                self.assertIn('log-format = "json"', printed)

    def test_variables_of_files_are_options(self):
        known = run(PROGRAMS / 'brume-server', '--help')
        for file in ('compose.yaml', 'Dockerfile', 'systemd/brume@.service', 'systemd/brume.service'):
            for name in re.findall(r'\bBRUME_[A-Z_]+\b', (DEPLOY / file).read_text()):
                if name not in ('BRUME_BIND', 'BRUME_METRICS_BIND'):  # HAProxy's
                    self.assertRegex(known, f'Env:{name}\\b', file)


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.packages = sorted(PACKAGES.glob('*.deb'))
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.root = pathlib.Path(cls.folder.name)
        for package in cls.packages:
            run('dpkg-deb', '-x', package, cls.root)

    def test_lintian(self):
        self.assertEqual([p.name.split('_')[0] for p in self.packages], ['brume-client', 'brume-server'])
        run('lintian', '--allow-root', '--tag-display-limit', '0', '--fail-on', 'error,warning', *self.packages)

    def test_programs_run_from_where_they_are_installed(self):
        for program in ('brume-server', 'brume-client', 'brume-load'):
            run(self.root / 'usr/bin' / program, '--version')
        # A name that is no scene makes it list those that it finds beside itself.
        with self.assertRaisesRegex(AssertionError, 'plume'):
            run(self.root / 'usr/bin/brume-server', '--scene', 'none', cwd='/')
        self.assertTrue((self.root / 'usr/share/brume/web/index.html').is_file())
        self.assertEqual((self.root / 'etc/brume/brume.toml').read_text(), (DEPLOY / 'brume.toml').read_text())

    def test_units(self):
        """In a system that has the package, and of systemd's own units the targets."""
        units = self.root / 'usr/lib/systemd/system'
        for target in pathlib.Path('/lib/systemd/system').glob('*.target'):
            if target.is_file() and not target.is_symlink():
                shutil.copy(target, units)
        (self.root / 'bin').mkdir()
        shutil.copy('/bin/kill', self.root / 'bin')
        said = run('systemd-analyze', 'verify', '--man=no', f'--root={self.root}', 'brume.service', 'brume@1.service')
        self.assertEqual(said, '')
        for unit in ('brume.service', 'brume@.service'):
            run('systemd-analyze', 'security', '--offline=true', '--no-pager', '--threshold=25', units / unit,
                env=os.environ | {'SYSTEMD_UNIT_PATH': f'{units}:'})


if __name__ == '__main__':
    unittest.main()
