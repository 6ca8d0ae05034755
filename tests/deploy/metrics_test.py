"""Every query of the dashboards, rules and alerts, at a real Prometheus that asks a real cluster by HAProxy."""
import contextlib
import json
import re
import subprocess
import unittest
import urllib.parse

from support import DEPLOY, PROGRAMS, ROOT, Cloud, get, until

# The parts of a query that name series: a metric, maybe with labels in braces.
SELECTOR = re.compile(r'\b(?:brume[:_]|process_|haproxy_)[a-z0-9_:]+(?:\{[^}]*\})?|\bup\{[^}]*\}')
# Labels of a grouping, which are none.
GROUPING = re.compile(r'\b(?:by|without|on|ignoring)\s*\([^)]*\)')
# Refusals that no test brings about; the metric has others. docs/operate.md names them.
REASONS = re.compile(r'reason[=!]~"([^"]*)"')
REFUSED = re.search(r'^\| `brume_refused_total.*$', (ROOT / 'docs/operate.md').read_text(), re.M)[0]


def dashboards():
    for file in sorted((DEPLOY / 'grafana/dashboards').glob('*.json')):
        for panel in json.loads(file.read_text())['panels']:
            for target in panel['targets']:
                query = re.sub(r'\$(instance|cluster)\b', '.*', target['expr'])
                yield f'{file.name}: {panel["title"]}', query


class Metrics(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cloud = Cloud(2, cluster=True)
        cls.addClassCleanup(cls.cloud.stop)
        cls.url = cls.cloud.prometheus()
        # Some series begin with what they count: pictures, their error, somebody who is refused.
        viewer = subprocess.Popen(
            [PROGRAMS / 'brume-load', '--server', f'ws://127.0.0.1:{cls.cloud.port}/ws', '--viewers', '1', '--seconds',
             '600', '--warm-up', '0', '--width', '160', '--height', '96', '--out', cls.cloud.path / 'load'],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        cls.addClassCleanup(viewer.wait)
        cls.addClassCleanup(viewer.kill)
        for _ in range(3):
            get(cls.cloud.url + '/', {'Host': 'elsewhere.example'})

    def ask(self, path, **parameters):
        status, _, body = get(f'{self.url}/api/v1/{path}?{urllib.parse.urlencode(parameters)}')
        answer = json.loads(body)
        self.assertEqual((status, answer['status']), (200, 'success'), f'{parameters}: {answer.get("error")}')
        return answer['data']

    def rules(self):
        for group in self.ask('rules')['groups']:
            for rule in group['rules']:
                yield f'rule {rule["name"]}', rule['query']

    def check(self, queries):
        queries = list(queries)
        self.assertGreater(len(queries), 20)
        for where, query in queries:
            with self.subTest(where):
                self.ask('query', query=query)
                selectors = SELECTOR.findall(GROUPING.sub('', query))
                for selector in selectors:
                    for reason in REASONS.findall(selector):
                        for name in reason.split('|'):
                            self.assertRegex(REFUSED, f'\\b{name}\\b')
                    selector = REASONS.sub('', selector)
                    # Some are there by turns: a measured error, while enough pixels of the last half minute are known.
                    recent = f'last_over_time({selector}[5m])'
                    until(f'there are series {selector}', lambda s=recent: self.ask('query', query=s)['result'], 40)

    def test_dashboards(self):
        self.check(dashboards())

    def test_rules(self):
        self.check(self.rules())

    def test_all_targets_are_up(self):
        def states():
            return {target['labels']['instance']: target['health'] for target in self.ask('targets')['activeTargets']}
        until('all are asked', lambda: set(states().values()) == {'up'})
        self.assertEqual(set(states()), {'n1', 'n2', 'haproxy'})
        self.assertEqual({target['labels']['cluster'] for target in self.ask('targets')['activeTargets']}, {'brume'})

    def test_no_alert_that_pages_fires_while_all_is_well(self):
        until('rules have been evaluated', lambda: self.ask('query', query='brume:nodes_ready:count')['result'])

        def pages():
            return [alert['labels'] for alert in self.ask('alerts')['alerts']
                    if alert['state'] == 'firing' and alert['labels']['severity'] == 'page']
        # On a busy machine the start itself may be a standstill, which its rule counts for a minute.
        with contextlib.suppress(AssertionError):
            until('no alert that pages fires', lambda: not pages(), 120)
        self.assertEqual(pages(), [])


if __name__ == '__main__':
    unittest.main()
