import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { lookAt, pivot } from '../src/camera';
import { Controls } from '../src/controls';
import type { ControlsHost } from '../src/controls';
import type { Command } from '../src/protocol';
import { Pusher } from '../src/pusher';

const FRAME_S = 1 / 60;
const SETTLED = 120; // animation frames after which a camera without keys stands

describe('keys', () => {
  let keyboard: EventTarget;
  let host: { -readonly [K in keyof ControlsHost]: ControlsHost[K] };
  let controls: Controls;
  let ending: AbortController;
  let sent: Command[];

  beforeEach(() => {
    ending = new AbortController();
    keyboard = new EventTarget();
    vi.stubGlobal('window', keyboard);
    vi.stubGlobal('HTMLElement', class {});
    host = {
      camera: lookAt([0, 0, 10], [0, 0, 0]),
      fovY: 0.8,
      mode: 'orbit',
      mayLook: true,
      pushing: false,
      touches: false,
      mayPush: true,
      touched: () => undefined,
      pushed: () => undefined,
    };
    const box = { left: 0, top: 0, width: 400, height: 200 };
    const surface = Object.assign(new EventTarget(), { clientHeight: box.height, getBoundingClientRect: () => box });
    sent = [];
    const pusher = new Pusher((command) => sent.push(command));
    controls = new Controls(surface as unknown as HTMLElement, keyboard as Window, host, pusher, ending.signal);
  });
  afterEach(() => {
    ending.abort();
    vi.unstubAllGlobals();
  });

  const key = (type: 'keydown' | 'keyup', code: string, held: { metaKey?: boolean } = {}): void => {
    const name = code.replace(/^Key|Left$|Right$/, '');
    const event = Object.assign(new Event(type, { cancelable: true }), { code, key: name, ...held });
    keyboard.dispatchEvent(event);
  };
  // The camera's distance from where it was before so many animation frames.
  const moved = (frames: number): number => {
    const { position } = host.camera;
    for (let i = 0; i < frames; ++i) controls.update(i * FRAME_S * 1000, FRAME_S);
    return Math.hypot(...host.camera.position.map((x, k) => x - (position[k] ?? NaN)));
  };

  test('that are held move the camera, until they are let go', () => {
    key('keydown', 'KeyS');
    expect(moved(60)).toBeGreaterThan(1);
    expect(moved(60)).toBeGreaterThan(1);
    key('keyup', 'KeyS');
    moved(SETTLED);
    expect(moved(60)).toBe(0);
  });

  for (const command of ['MetaLeft', 'MetaRight'])
    test(`are let go with ${command}, as macOS tells of none that is let go before it`, () => {
      key('keydown', 'KeyS');
      moved(10);
      key('keydown', command, { metaKey: true });
      key('keyup', command);
      moved(SETTLED);
      expect(moved(60)).toBe(0);
      key('keydown', 'KeyS');
      expect(moved(10)).toBeGreaterThan(0);
    });

  test('that are pressed with Command are the browser’s, and are let go with it', () => {
    key('keydown', 'MetaLeft', { metaKey: true });
    key('keydown', 'KeyS', { metaKey: true });
    expect(moved(10)).toBe(0);
    key('keyup', 'MetaLeft');
    expect(moved(10)).toBe(0);
  });

  test('that are tapped for no time move the camera a step', () => {
    key('keydown', 'KeyS');
    key('keyup', 'KeyS');
    expect(moved(1)).toBeGreaterThan(0);
    moved(SETTLED);
    expect(moved(60)).toBe(0);
    const { yaw } = host.camera;
    key('keydown', 'ArrowLeft');
    key('keyup', 'ArrowLeft');
    moved(1);
    const turned = host.camera.yaw;
    expect(turned).not.toBe(yaw);
    moved(60);
    expect(host.camera.yaw).toBe(turned);
  });

  test('with arrows push along them while pushes are on, and turn nothing', () => {
    host.pushing = true;
    key('keydown', 'ArrowRight');
    expect(moved(30)).toBe(0);
    const [first] = sent;
    expect(sent.length).toBeGreaterThan(5);
    expect(first).toMatchObject({ kind: 'impulse' });
    const [x = 0, y = 0, z = 0] = (first as unknown as { push: number[] }).push;
    expect(x).toBeGreaterThan(1);
    expect(Math.hypot(y, z)).toBeLessThan(1e-6);
    key('keyup', 'ArrowRight');
    moved(1);
    const count = sent.length;
    expect(moved(60)).toBe(0);
    expect(sent.length).toBe(count);
    host.mayPush = false; // a viewer's arrows turn
    key('keydown', 'ArrowRight');
    expect(moved(10)).toBeGreaterThan(0);
    expect(sent.length).toBe(count);
  });

  test('are let go when the focus is lost', () => {
    key('keydown', 'KeyS');
    key('keydown', 'ArrowLeft');
    moved(10);
    keyboard.dispatchEvent(new Event('blur'));
    moved(SETTLED);
    const { yaw } = host.camera;
    expect(moved(60)).toBe(0);
    expect(host.camera.yaw).toBe(yaw);
  });
});

describe('where a drag pushes', () => {
  const sent: Command[] = [];
  let surface: EventTarget;
  let host: { -readonly [K in keyof ControlsHost]: ControlsHost[K] };
  let pusher: Pusher;
  let ending: AbortController;

  beforeEach(() => {
    ending = new AbortController();
    vi.stubGlobal('window', Object.assign(new EventTarget(), { clearTimeout, setTimeout }));
    vi.stubGlobal('document', { activeElement: null });
    vi.stubGlobal('HTMLElement', class {});
    sent.length = 0;
    const getBoundingClientRect = () => ({ left: 0, top: 0, width: 400, height: 300 });
    surface = Object.assign(new EventTarget(), {
      setPointerCapture: () => undefined,
      clientHeight: 300,
      getBoundingClientRect,
    });
    host = {
      ...{ camera: lookAt([0, 0, 10], [0, 0, 0]), fovY: 0.8, mode: 'orbit', mayLook: true, mayPush: true },
      ...{ pushing: true, touches: true, touched: () => undefined, pushed: () => undefined },
    };
    pusher = new Pusher((command) => void sent.push(command));
    new Controls(surface as HTMLElement, window as never, host, pusher, ending.signal);
  });
  afterEach(() => {
    ending.abort();
    vi.unstubAllGlobals();
  });

  const pointer = (type: string, pointerId: number, x: number, y: number, button = 0): void => {
    const event = Object.assign(new Event(type, { cancelable: true }), { pointerId, clientX: x, clientY: y, button });
    surface.dispatchEvent(Object.assign(event, { pointerType: 'touch' }));
  };

  test('one finger pushes and leaves the camera; two turn it about the same point, and do not push', () => {
    const home = host.camera;
    pointer('pointerdown', 1, 200, 150);
    pointer('pointermove', 1, 240, 150);
    pusher.update(performance.now() + 100);
    expect(sent.map(({ kind }) => kind)).toEqual(['impulse']);
    expect(host.camera).toBe(home);

    pointer('pointerdown', 2, 300, 150);
    for (const id of [1, 2]) pointer('pointermove', id, 240 + 60 * id, 150);
    pusher.update(performance.now() + 1000);
    for (const id of [1, 2]) pointer('pointerup', id, 0, 0);
    expect(sent).toHaveLength(1);
    expect(host.camera.yaw).not.toBe(home.yaw);
    for (const x of pivot(host.camera)) expect(x).toBeCloseTo(0, 9);
  });

  test('another button turns, too', () => {
    pointer('pointerdown', 1, 200, 150, 2);
    pointer('pointermove', 1, 240, 150);
    expect(sent).toHaveLength(0);
    expect(host.camera.yaw).not.toBe(0);
    for (const x of pivot(host.camera)) expect(x).toBeCloseTo(0, 9);
  });
});
