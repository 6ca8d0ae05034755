// One WebSocket to the server: connects, says hello, reads messages, and connects again when the connection breaks.
import { beside } from './address';
import { Backoff } from './backoff';
import { decode } from './decode';
import { encodeAck, encodeGoodbye, encodeHello, encodeInput, encodePing, encodePong, encodePose } from './encode';
import { answers, pageOf } from './move';
import { SUBPROTOCOL } from './protocol';
import type { Command, HelloMessage, PoseMessage, ServerMessage, Welcome } from './protocol';
import type { Renewal } from './renewal';

export type Refusal = 'full' | 'version' | 'blocked' | 'origin' | 'goodbye' | 'token' | 'login' | 'room';

// `retryAt`: time of the next try, on performance.now()'s clock; undefined while one is under way, Infinity if none
// comes by itself.
export type LinkState =
  | { name: 'connecting' }
  | { name: 'connected'; welcome: Welcome }
  | { name: 'reconnecting'; text: string; retryAt: number | undefined }
  | { name: 'refused'; refusal: Refusal; text: string; retryAt: number | undefined };

export interface LinkEvents {
  hello(): HelloMessage;
  state(state: LinkState): void;
  message(message: ServerMessage, bytes: number): void;
  roundTrip(ms: number): void;
  // Another token, when the server takes this one no more, or why there is none; undefined where nobody gives any.
  renew?(): Promise<Renewal | undefined>;
  // The server has stopped, and the page of another server that it named answers: the viewer goes there.
  moved(page: string): void;
}

const HANDSHAKE_MS = 8000; // from opening to welcome
const SILENCE_MS = 8000; // the server reports the scene each second; longer silence is a dead connection
const PING_MS = 2000;
const ASK_MS = 2000;
const MOVE_MS = 10_000; // a page that has not been left by then connects here again
// Bytes that the socket has not sent yet. With more, the network is behind, and another pose would only arrive late.
const UNSENT_LIMIT = 64 * 1024;
// A wait this long is shown as a refusal, a shorter one as an interruption.
const LONG_WAIT_S = 3;
const ERROR_FULL = 5;
// After so many handshakes that a healthy server refused, the page says that its version is outdated. Fewer may be a
// gateway that has not noticed yet that one of its servers is gone.
const DECLINED_LIMIT = 4;
// After so many a page that never was connected gives up: no time mends a proxy that passes no WebSockets on.
const HOPELESS_LIMIT = 6;
const TOKEN_WAIT_S = 30; // another token comes with a new address of the page

export const nowUs = (): bigint => BigInt(Math.round(performance.now() * 1000));

export class Connection {
  private socket: WebSocket | undefined;
  private welcomed = false;
  private resume = ''; // Welcome.resume of the last welcome: the key to be the same viewer again
  private everWelcomed = false;
  private renews = false; // true: the token was renewed just now, and a third would be as bad
  private inputSeq = 0;
  private poseSeq = 0;
  private nonce = 0;
  private heardAt = 0;
  private openedAt = 0;
  private declined = 0;
  private away = false; // true: when a socket failed last, nobody answered over HTTP either
  private looking = false;
  private askedWait = 0;
  private hopeless = false; // true: no try comes by itself
  private goTo: string | undefined; // page that the last goodbye named
  private parting: { refusal?: Refusal; text: string } | undefined;
  private timer: number | undefined;
  private clock: number | undefined;
  private readonly backoff = new Backoff();
  private state: LinkState = { name: 'connecting' };

  constructor(
    private url: string,
    private readonly events: LinkEvents,
    private readonly ending: AbortSignal,
  ) {}

  start(): void {
    const until = { signal: this.ending };
    window.addEventListener('online', () => this.hurry(), until);
    document.addEventListener('visibilitychange', () => document.hidden || this.hurry(), until);
    // Makes room for another viewer at once. A page that comes back from the browser's cache connects again.
    window.addEventListener('pagehide', () => this.leave('page closed'), until);
    window.addEventListener('pageshow', (event) => event.persisted && this.retryNow(), until);
    this.setState({ name: 'connecting' });
    this.open();
  }

  // Closes the connection for good.
  stop(): void {
    window.clearTimeout(this.timer);
    this.leave('viewer closed');
  }

  // Closes the connection and connects again at once, with a new hello.
  reopen(): void {
    this.leave('reconnecting');
    this.retryNow();
  }

  retryNow(): void {
    if (this.socket || this.ending.aborted) return;
    window.clearTimeout(this.timer);
    if (this.goTo !== undefined) void this.goOn(this.goTo);
    else if (this.away) void this.look();
    else this.open();
  }

  // Opens a socket once somebody answers over HTTP. Firefox holds sockets back where others have failed before, the
  // longer the more of them did, up to a minute.
  private async look(): Promise<void> {
    if (this.looking) return;
    this.looking = true;
    this.askedWait = 0;
    this.trying();
    const there = await this.ask(new URL(this.url), 'GET', 'no-cors').then(
      ({ type, status }) => type === 'opaque' || status < 500, // more: a gateway without a server
      () => false,
    );
    this.looking = false;
    if (this.socket || this.ending.aborted) return; // another try has begun meanwhile, or none is wanted
    if (there) this.open();
    else this.ended();
  }

  // Moves to another server's page, or connects here again if nobody answers there.
  private async goOn(page: string): Promise<void> {
    const there = await answers(page);
    if (this.socket || this.ending.aborted) return; // another try has begun meanwhile, or none is wanted
    if (!there) return this.open();
    window.clearTimeout(this.timer); // of another that was asked for meanwhile
    this.timer = window.setTimeout(() => this.open(), MOVE_MS);
    this.events.moved(page);
  }

  get connected(): boolean {
    return this.welcomed;
  }

  // Number of the last pose that was sent; 0 if this connection has sent none.
  get lastPose(): number {
    return this.poseSeq;
  }

  // Returns false if the pose was not sent, since the connection is away or behind. A later try will have a newer
  // pose.
  sendPose(pose: Omit<PoseMessage, 'seq' | 'clientTimeUs'>): boolean {
    if (!this.welcomed || !this.socket || this.socket.bufferedAmount > UNSENT_LIMIT) return false;
    this.poseSeq += 1;
    this.send(encodePose({ ...pose, seq: this.poseSeq, clientTimeUs: nowUs() }));
    return true;
  }

  sendInput(command: Command): boolean {
    if (!this.welcomed) return false;
    this.inputSeq += 1;
    this.send(encodeInput(this.inputSeq, nowUs(), command));
    return true;
  }

  // A message that is no pose and no input; lost without a connection.
  sendMessage(message: Uint8Array<ArrayBuffer>): void {
    if (this.welcomed) this.send(message);
  }

  acknowledge(frame: number): void {
    if (this.welcomed) this.send(encodeAck(frame));
  }

  private setState(state: LinkState): void {
    this.state = state;
    this.events.state(state);
  }

  private send(message: Uint8Array<ArrayBuffer>): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(message);
  }

  private open(): void {
    const socket = new WebSocket(this.url, SUBPROTOCOL);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.welcomed = false;
    this.parting = undefined;
    this.askedWait = 0;
    this.hopeless = false;
    this.inputSeq = 0;
    this.poseSeq = 0;
    this.openedAt = this.heardAt = performance.now();
    let opened = false;
    this.trying();
    socket.onopen = () => {
      opened = true;
      this.away = false;
      this.declined = 0;
      this.send(encodeHello({ ...this.events.hello(), resume: this.resume }));
    };
    socket.onmessage = (event: MessageEvent<unknown>) => {
      if (this.socket === socket) this.receive(event.data);
    };
    socket.onclose = () => {
      if (this.socket !== socket) return; // closed by leave() or tick(), or replaced
      this.socket = undefined;
      window.clearInterval(this.clock);
      if (opened) this.ended();
      else void this.turnedDown();
    };
    this.clock = window.setInterval(() => this.tick(socket), 1000);
  }

  // A retry keeps the state and ends its countdown.
  private trying(): void {
    if (this.state.name === 'reconnecting' || this.state.name === 'refused') {
      this.setState({ ...this.state, retryAt: undefined });
    }
  }

  private receive(data: unknown): void {
    this.heardAt = performance.now();
    let message: ServerMessage;
    try {
      if (!(data instanceof ArrayBuffer)) throw new Error('not a binary message');
      message = decode(data);
    } catch (error) {
      return this.unreadable(error);
    }
    switch (message.kind) {
      case 'ping':
        this.send(encodePong(message.nonce, message.timeUs));
        return;
      case 'pong':
        this.events.roundTrip(performance.now() - Number(message.timeUs) / 1000);
        return;
      case 'welcome':
        this.welcomed = this.everWelcomed = true;
        this.renews = false;
        this.resume = message.resume;
        this.goTo = undefined;
        this.backoff.reset();
        this.ping();
        this.setState({ name: 'connected', welcome: message });
        break;
      case 'error':
        if (message.code === ERROR_FULL) this.parting = { refusal: 'full', text: message.text };
        break;
      case 'goodbye':
        this.askedWait = message.retryAfterS > 0 ? message.retryAfterS : 0;
        this.goTo = pageOf(message.goTo, this.url);
        this.parting = { ...this.parting, text: message.reason || this.parting?.text || '' };
        if (!this.parting.refusal && this.askedWait >= LONG_WAIT_S) this.parting.refusal = 'goodbye';
        this.socket?.close(1000);
        break;
    }
    this.events.message(message, (data as ArrayBuffer).byteLength);
  }

  // The server sent what this page cannot read. If it is the first message, the server is of another version. If it is
  // a later one, the connection is broken.
  unreadable(error: unknown): void {
    console.error('brume: the server sent what this page cannot read:', error);
    this.parting = this.welcomed ? { text: 'A message was damaged.' } : versionRefusal();
    this.socket?.close(4000, 'unreadable message');
  }

  private tick(socket: WebSocket): void {
    if (this.socket !== socket) return;
    const now = performance.now();
    const late = this.welcomed ? now - this.heardAt > SILENCE_MS : now - this.openedAt > HANDSHAKE_MS;
    if (late) {
      // close() waits for the server, which is silent: the socket is given up before.
      this.socket = undefined;
      window.clearInterval(this.clock);
      socket.close();
      this.parting ??= { text: 'The server stopped answering.' };
      this.ended();
    } else if (this.welcomed && this.nonce * PING_MS < now) {
      this.ping();
    }
  }

  private ping(): void {
    this.nonce = Math.floor(performance.now() / PING_MS) + 1;
    this.send(encodePing(this.nonce, nowUs()));
  }

  // The handshake failed: nobody is there, the server wants another token, or it does not speak this version. A
  // browser does not say which. So the page asks the same address over HTTP, which answers in one line.
  private async turnedDown(): Promise<void> {
    const [{ refusal, text, there }, alive] = await Promise.all([this.asked(), this.isAlive()]);
    if (this.socket || this.ending.aborted) return; // another try has begun meanwhile, or none is wanted
    this.away = !alive;
    this.declined = alive && there && !refusal ? this.declined + 1 : 0;
    const another = refusal === 'token' && !this.renews ? await this.events.renew?.() : undefined;
    if (this.socket || this.ending.aborted) return; // as above
    if (another && 'token' in another) return this.openWith(another.token);
    if (refusal) {
      this.parting = another ?? { refusal, text };
      [this.renews, this.askedWait] = [false, TOKEN_WAIT_S]; // a third may be asked for after that
      this.hopeless = refusal === 'blocked' && !this.everWelcomed;
    } else if (this.declined >= DECLINED_LIMIT) {
      this.parting = text.includes(SUBPROTOCOL) ? blockedRefusal('WebSockets') : versionRefusal();
      this.askedWait = 5;
      const blocked = this.parting.refusal === 'blocked';
      this.hopeless = blocked && !this.everWelcomed && this.declined >= HOPELESS_LIMIT;
    }
    this.ended();
  }

  private openWith(token: string): void {
    this.renews = true;
    const address = new URL(this.url);
    address.searchParams.set('token', token);
    this.url = address.href;
    this.open();
  }

  private isAlive(): Promise<boolean> {
    return this.ask(new URL('healthz', this.url)).then(
      (response) => response.ok,
      () => false,
    );
  }

  // What the socket's own address says, in one line: why it refuses this page's token or origin, or what it is.
  // `there`: false if a gateway says that the server behind it is gone. A browser names a page's origin to the page's
  // own host only with methods like OPTIONS.
  private async asked(): Promise<{ there: boolean; refusal?: Refusal; text: string }> {
    const said = { there: true, text: '' };
    for (const method of ['OPTIONS', 'GET'])
      try {
        const answer = await this.ask(new URL(this.url), method);
        const text = (await answer.text()).split('\n')[0]?.slice(0, 300) ?? '';
        if (answer.headers.get('brume-refused') === 'room') return { ...said, refusal: 'room', text };
        if (answer.headers.get('brume-refused') === 'origin') {
          // The server takes its own page for that of another site: it was asked by another name.
          const own = new URL(this.url).host === location.host;
          return {
            ...said,
            ...(own ? blockedRefusal('the Host header (nor, perhaps, WebSockets)') : { refusal: 'origin', text }),
          };
        }
        if (method === 'OPTIONS') continue;
        if (answer.status === 401 || answer.status === 403) return { ...said, refusal: 'token', text };
        return { there: answer.status < 500, text };
      } catch {
        // Nobody answers, or the browser keeps the answer to itself.
      }
    return said;
  }

  private ask(address: URL, method = 'GET', mode: RequestMode = 'cors'): Promise<Response> {
    const page = address.href.replace(/^ws/, 'http');
    return fetch(page, { method, mode, cache: 'no-store', signal: AbortSignal.timeout(ASK_MS) });
  }

  private ended(): void {
    this.welcomed = false;
    const parting = this.parting;
    const wait = this.hopeless ? Infinity : this.backoff.next(this.askedWait);
    const retryAt = performance.now() + wait * 1000;
    if (!this.hopeless) this.timer = window.setTimeout(() => this.retryNow(), wait * 1000);
    if (parting?.refusal) {
      this.setState({ name: 'refused', refusal: parting.refusal, text: parting.text, retryAt });
    } else {
      const text = parting?.text ?? (this.everWelcomed ? '' : 'No answer from the server.');
      this.setState({ name: 'reconnecting', text, retryAt });
    }
  }

  // Tries again at once after an interruption, but never cuts short a wait that the server asked for. The timers of a
  // page that nobody saw are late: a connection may have died unnoticed.
  hurry(): void {
    if (this.socket) this.tick(this.socket);
    if (this.hopeless || (this.state.name === 'reconnecting' && this.askedWait === 0)) this.retryNow();
  }

  private leave(reason: string): void {
    const socket = this.socket;
    if (!socket) return;
    this.resume = ''; // after a goodbye the server forgets the viewer
    this.send(encodeGoodbye(reason));
    this.socket = undefined;
    this.welcomed = false;
    window.clearInterval(this.clock);
    socket.close(1000);
  }
}

const versionRefusal = (): { refusal: Refusal; text: string } => ({
  refusal: 'version',
  text: 'The server turned this page away.',
});

const blockedRefusal = (what: string): { refusal: Refusal; text: string } => ({
  refusal: 'blocked',
  text: `The proxy in front of this server does not pass ${what} on: see docs/deploy.md.`,
});
