// Addresses beside a page, wherever a proxy has put it: below a prefix (https://host/clouds/brume/) as well as at the
// root. All that the page asks for lies beside it.

// A last part without a dot is a folder whose slash was left out: https://host/clouds/brume. `ws` is a socket.
export function withSlash(page: string | URL): URL {
  const address = new URL(page);
  if (!/\/(ws|[^/]*\.[^/]*)?$/.test(address.pathname)) address.pathname += '/';
  return address;
}

// What the server has under that name: beside('https://host/clouds/brume', 'ws').
export const beside = (page: string | URL, name: string): URL => new URL(name, withSlash(page));

// Names under which a tab keeps something of the page at that path: its own first, then those of the folders above.
// Several servers may share one host, each below a prefix of its own.
export function keptNames(name: string, path: string): [own: string, ...above: string[]] {
  const names: string[] = [];
  for (let end = path.lastIndexOf('/'); end > 0; end = path.lastIndexOf('/', end - 1))
    names.push(`${name} ${path.slice(0, end + 1)}`);
  const [own, ...above] = [...names, name];
  return [own ?? name, ...above];
}

// The address of a server's socket: `source` itself where it is a socket's (ws: or wss:), else "ws" beside the page
// `source`, wherever a proxy has put it; over TLS if that page comes over TLS.
export function socketAddress(source: string, token: string | undefined): string {
  const named = new URL(source, location.href);
  const address = /^wss?:$/.test(named.protocol) ? named : beside(named, 'ws');
  address.protocol = address.protocol.replace('http', 'ws');
  address.search = address.hash = '';
  if (token !== undefined) address.searchParams.set('token', token);
  return address.href;
}
