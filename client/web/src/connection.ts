// One WebSocket to the server, kept alive: connects, says hello, listens, and comes back by itself when it breaks.
import { Backoff } from './backoff';
import { decode } from './decode';
import { encodeAck, encodeGoodbye, encodeHello, encodeInput, encodePing, encodePong, encodePose } from './encode';
import { answers, pageOf } from './move';
import { SUBPROTOCOL } from './protocol';
import type { Command, HelloMessage, PoseMessage, ServerMessage, Welcome } from './protocol';

export type Refusal = 'full' | 'version' | 'goodbye' | 'token';

// `retryAt` is on performance.now()'s clock; undefined while a try is under way.
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
  // The server has stopped, and there is an answer from the page that it named.
  moved(page: string): void;
}

const HANDSHAKE_MS = 8000; // from opening to welcome
const SILENCE_MS = 8000; // the server reports the scene each second; longer silence is a dead connection
const PING_MS = 2000;
const MOVE_MS = 10_000; // a page that is still here then was not left
// With this much still unsent the network is behind, and another pose would only be older when it arrives.
const UNSENT_LIMIT = 64 * 1024;
// A wait this long is worth telling as a refusal instead of as an interruption.
const LONG_WAIT_S = 3;
const ERROR_FULL = 5;
// Handshakes that a healthy server turned down before the page takes itself for outdated.
const DECLINED_LIMIT = 2;
const TOKEN_WAIT_S = 30; // another token comes with a new address of the page

export const nowUs = (): bigint => BigInt(Math.round(performance.now() * 1000));

export class Connection {
  private socket: WebSocket | undefined;
  private welcomed = false;
  private resume = ''; // of the last welcome
  private everWelcomed = false;
  private inputSeq = 0;
  private poseSeq = 0;
  private nonce = 0;
  private heardAt = 0;
  private openedAt = 0;
  private declined = 0;
  private askedWait = 0;
  private goTo: string | undefined; // of the last goodbye
  private parting: { refusal?: Refusal; text: string } | undefined;
  private timer: number | undefined;
  private clock: number | undefined;
  private readonly backoff = new Backoff();
  private state: LinkState = { name: 'connecting' };

  constructor(
    private readonly url: string,
    private readonly events: LinkEvents,
  ) {}

  start(): void {
    window.addEventListener('online', () => this.hurry());
    document.addEventListener('visibilitychange', () => document.hidden || this.hurry());
    // Gives the place back at once; a page that comes back from the browser's cache connects anew.
    window.addEventListener('pagehide', () => this.leave('page closed'));
    window.addEventListener('pageshow', (event) => event.persisted && this.retryNow());
    this.setState({ name: 'connecting' });
    this.open();
  }

  // Closes and connects anew at once, with a new hello.
  reopen(): void {
    this.leave('reconnecting');
    this.retryNow();
  }

  retryNow(): void {
    if (this.socket) return;
    window.clearTimeout(this.timer);
    if (this.goTo === undefined) this.open();
    else void this.goOn(this.goTo);
  }

  // Elsewhere, or here again when nobody answers there.
  private async goOn(page: string): Promise<void> {
    if (await answers(page)) {
      this.events.moved(page);
      this.timer = window.setTimeout(() => this.open(), MOVE_MS);
    } else if (!this.socket) this.open();
  }

  get connected(): boolean {
    return this.welcomed;
  }

  // Of the last pose sent; 0 when this connection has sent none.
  get lastPose(): number {
    return this.poseSeq;
  }

  // False when the pose was not sent: another try will have a newer one.
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
    this.inputSeq = 0;
    this.poseSeq = 0;
    this.openedAt = this.heardAt = performance.now();
    let opened = false;
    // While trying again the state stays what it was: only its countdown ends.
    if (this.state.name === 'reconnecting' || this.state.name === 'refused') {
      this.setState({ ...this.state, retryAt: undefined });
    }
    socket.onopen = () => {
      opened = true;
      this.declined = 0;
      this.send(encodeHello({ ...this.events.hello(), resume: this.resume }));
    };
    socket.onmessage = (event: MessageEvent<unknown>) => {
      if (this.socket === socket) this.receive(event.data);
    };
    socket.onclose = () => {
      if (this.socket !== socket) return; // left on purpose
      this.socket = undefined;
      window.clearInterval(this.clock);
      if (opened) this.ended();
      else void this.turnedDown();
    };
    this.clock = window.setInterval(() => this.tick(socket), 1000);
  }

  private receive(data: unknown): void {
    this.heardAt = performance.now();
    let message: ServerMessage;
    try {
      if (!(data instanceof ArrayBuffer)) throw new Error('not a binary message');
      message = decode(data);
    } catch (error) {
      console.error('brume: the server sent what this page cannot read:', error);
      // A first message that makes no sense comes from another version; a later one from a broken connection.
      this.parting = this.welcomed ? { text: 'A message was damaged.' } : versionRefusal();
      this.socket?.close(4000, 'unreadable message');
      return;
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
        this.goTo = pageOf(message.goTo, location.href);
        this.parting = { ...this.parting, text: message.reason || this.parting?.text || '' };
        if (!this.parting.refusal && this.askedWait >= LONG_WAIT_S) this.parting.refusal = 'goodbye';
        this.socket?.close(1000);
        break;
    }
    this.events.message(message, (data as ArrayBuffer).byteLength);
  }

  private tick(socket: WebSocket): void {
    if (this.socket !== socket) return;
    const now = performance.now();
    const late = this.welcomed ? now - this.heardAt > SILENCE_MS : now - this.openedAt > HANDSHAKE_MS;
    if (late) {
      // close() waits for the other side, which is silent: give the socket up first.
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

  // The handshake failed. Nobody there, or a server that wants another token, or one that does not speak this version? A page is
  // not told why: the same address over HTTP answers in one line.
  private async turnedDown(): Promise<void> {
    const wants = await this.whatItWants();
    const alive = await fetch('healthz', { cache: 'no-store', signal: AbortSignal.timeout(2000) }).then(
      (response) => response.ok,
      () => false,
    );
    if (this.socket) return; // someone asked for another try meanwhile
    this.declined = alive && wants === undefined ? this.declined + 1 : 0;
    if (wants !== undefined) {
      this.parting = { refusal: 'token', text: wants };
      this.askedWait = TOKEN_WAIT_S;
    } else if (this.declined >= DECLINED_LIMIT) {
      this.parting = versionRefusal();
      this.askedWait = 5;
    }
    this.ended();
  }

  // Of who connects; undefined when our token is good enough, or nobody answers.
  private async whatItWants(): Promise<string | undefined> {
    try {
      const answer = await fetch(this.url.replace(/^ws/, 'http'), {
        cache: 'no-store',
        signal: AbortSignal.timeout(2000),
      });
      if (answer.status !== 401 && answer.status !== 403) return undefined;
      return (await answer.text()).split('\n')[0]?.slice(0, 200) ?? '';
    } catch {
      return undefined;
    }
  }

  private ended(): void {
    this.welcomed = false;
    const wait = this.backoff.next(this.askedWait);
    const retryAt = performance.now() + wait * 1000;
    this.timer = window.setTimeout(() => this.retryNow(), wait * 1000);
    const parting = this.parting;
    if (parting?.refusal) {
      this.setState({ name: 'refused', refusal: parting.refusal, text: parting.text, retryAt });
    } else {
      const text = parting?.text ?? (this.everWelcomed ? '' : 'No answer from the server.');
      this.setState({ name: 'reconnecting', text, retryAt });
    }
  }

  // An interruption is worth another try at once; a wait that the server asked for is not.
  private hurry(): void {
    if (this.state.name === 'reconnecting' && this.askedWait === 0) this.retryNow();
  }

  private leave(reason: string): void {
    const socket = this.socket;
    if (!socket) return;
    this.resume = ''; // who says goodbye does not come back as the same
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

// Beside the page, wherever a proxy has put it, and over TLS when the page came so.
export function socketAddress(token: string | undefined): string {
  const address = new URL('ws', location.href);
  address.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
  address.search = address.hash = '';
  if (token !== undefined) address.searchParams.set('token', token);
  return address.href;
}
