// A stand-in for a long or narrow way: passes TCP on to a server, every byte `ms` later, in either direction, and no more
// than `rate` bytes a second from it.
import { connect, createServer } from 'node:net';

const PACKET = 1460; // bytes

// Where a page finds the server through it: { url, stop(), become() }. become(more) makes the way longer from now on.
export async function startDelay(url, ms, rate = Infinity) {
  const { hostname, port } = new URL(url);
  const sockets = new Set();
  const pass = (from, to, most = Infinity) => {
    const waiting = []; // in the order of the bytes, which timers of several lengths do not keep
    let free = 0; // when the narrow way has passed on what came before
    const later = (act, bytes = 0) => {
      const now = performance.now();
      free = Math.max(free, now) + (1000 * bytes) / most;
      waiting.push(act);
      setTimeout(() => waiting.shift()(), ms + free - now);
    };
    const send = (packet) => later(() => to.destroyed || to.write(packet), packet.length);
    from.on('data', (chunk) => {
      if (most === Infinity) return send(chunk);
      for (let at = 0; at < chunk.length; at += PACKET) send(chunk.subarray(at, at + PACKET));
    });
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
    pass(far, near, rate);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${server.address().port}`,
    become(more) {
      ms = more; // no less than before: bytes keep their order
    },
    stop() {
      server.close();
      for (const socket of sockets) socket.destroy();
    },
  };
}
