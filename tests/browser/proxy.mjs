// A stand-in for an HTTP proxy that serves a server below prefixes, which it takes away, and pages of its own elsewhere.
import { createServer, request } from 'node:http';
import { connect } from 'node:net';

// `pages`: bodies by path. Returns { url, astray, stop() }; `astray`: paths that were asked for in vain.
export async function startProxy(target, prefixes, pages = {}) {
  const { hostname, port } = new URL(target);
  const sockets = new Set();
  const astray = [];
  const onward = (path) => {
    const prefix = prefixes.find((one) => path.startsWith(one));
    return prefix && path.slice(prefix.length - 1);
  };
  const proxy = createServer((incoming, outgoing) => {
    const path = onward(incoming.url);
    if (path === undefined) {
      const page = pages[incoming.url];
      if (page === undefined && incoming.url !== '/favicon.ico') astray.push(incoming.url);
      outgoing.writeHead(page === undefined ? 404 : 200, { 'content-type': 'text/html; charset=utf-8' });
      return outgoing.end(page ?? 'nothing here');
    }
    const { method, headers } = incoming;
    const far = request({ hostname, port, path, method, headers }, (answer) =>
      answer.pipe(outgoing.writeHead(answer.statusCode, answer.headers)),
    );
    far.on('error', () => outgoing.destroy());
    outgoing.on('close', () => far.destroy());
    incoming.pipe(far);
  });
  proxy.on('connection', (socket) => sockets.add(socket));
  proxy.on('upgrade', (incoming, socket) => {
    const path = onward(incoming.url);
    if (path === undefined) {
      astray.push(incoming.url);
      return socket.destroy();
    }
    const far = connect(port, hostname);
    sockets.add(far);
    for (const end of [far, socket]) end.on('error', () => end.destroy()).on('close', () => (far.end(), socket.end()));
    const lines = Object.entries(incoming.headers).map(([name, value]) => `${name}: ${value}`);
    far.write([`GET ${path} HTTP/1.1`, ...lines, '', ''].join('\r\n'));
    far.pipe(socket).pipe(far);
  });
  await new Promise((resolve) => proxy.listen(0, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${proxy.address().port}`,
    astray,
    stop() {
      for (const socket of sockets) socket.destroy();
      proxy.close();
    },
  };
}
