// A stand-in for a gateway before several servers: passes TCP on to the first of them that takes the connection.
import { connect, createServer } from 'node:net';

// Where a page finds the servers through it: { url, stop() }.
export async function startGateway(...urls) {
  const sockets = new Set();
  const pass = (near, at) => {
    if (at === urls.length) return void near.destroy(); // no server is there
    const { hostname, port } = new URL(urls[at]);
    const far = connect(Number(port), hostname);
    sockets.add(far);
    let through = false;
    far.on('connect', () => {
      through = true;
      near.pipe(far).pipe(near);
    });
    far.on('error', () => {}); // it closes, too
    far.on('close', () => {
      sockets.delete(far);
      if (through) near.destroy();
      else pass(near, at + 1);
    });
    near.on('close', () => far.destroy());
  };
  const gateway = createServer((near) => {
    sockets.add(near);
    near.on('error', () => {});
    near.on('close', () => sockets.delete(near));
    pass(near, 0);
  });
  await new Promise((resolve) => gateway.listen(0, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${gateway.address().port}`,
    stop() {
      gateway.close();
      for (const socket of sockets) socket.destroy();
    },
  };
}
