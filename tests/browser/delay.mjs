// A stand-in for a long way: passes TCP on to a server, every byte `ms` later, in either direction.
import { connect, createServer } from 'node:net';

// Where a page finds the server through it: { url, stop() }.
export async function startDelay(url, ms) {
  const { hostname, port } = new URL(url);
  const sockets = new Set();
  const pass = (from, to) => {
    const later = (act) => setTimeout(() => to.destroyed || act(), ms); // timers of one length keep their order
    from.on('data', (chunk) => later(() => to.write(chunk)));
    from.on('end', () => later(() => to.end()));
    from.on('error', () => later(() => to.destroy()));
    from.on('close', () => {
      sockets.delete(from);
      later(() => to.end());
    });
  };
  const server = createServer((near) => {
    const far = connect(Number(port), hostname);
    for (const socket of [near, far]) {
      socket.setNoDelay(true);
      sockets.add(socket);
    }
    pass(near, far);
    pass(far, near);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${server.address().port}`,
    stop() {
      server.close();
      for (const socket of sockets) socket.destroy();
    },
  };
}
