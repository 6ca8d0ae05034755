// What the parts of a viewer ask of it: controls.ts and drawing.ts.
import type { Camera } from './camera';
import type { Connection } from './connection';
import type { ControlsHost, Mode } from './controls';
import type { DrawingHost } from './drawing';
import type { People, PeopleHost } from './people';
import type { Poses } from './poses';
import type { Welcome } from './protocol';
import type { Statistics } from './statistics';
import type { ViewerEvents, Wishes } from './viewer-host';
import type { Viewing } from './viewing';

interface Controlled {
  camera: Camera;
  readonly mode: Mode;
  readonly fovY: number;
  readonly pushing: boolean;
  readonly mayPush: boolean;
  readonly wishes: Wishes;
  readonly people: People;
}

export function controlsHost(viewer: Controlled, poses: Poses, events: ViewerEvents): ControlsHost {
  return {
    get camera() {
      return viewer.camera;
    },
    set camera(value) {
      if (!viewer.people.takesBack()) return;
      viewer.camera = value;
      poses.moved();
    },
    get mode() {
      return viewer.mode;
    },
    get fovY() {
      return viewer.fovY;
    },
    get pushing() {
      return viewer.pushing || this.touches;
    },
    get touches() {
      return viewer.wishes.control === 'touch' && viewer.mayPush;
    },
    get mayPush() {
      return viewer.mayPush;
    },
    get mayLook() {
      return viewer.wishes.control !== 'none';
    },
    touched: () => events.touched(),
    pushed: (active, x, y) => events.pushed(active, x, y),
  };
}

interface Drawer {
  readonly link: Connection;
  readonly viewing: Viewing;
  readonly statistics: Statistics;
  readonly headset: DrawingHost['headset'];
  readonly wishes: Wishes;
}

export function drawingHost(viewer: Drawer, events: ViewerEvents): DrawingHost {
  return {
    wishes: viewer.wishes,
    get headset() {
      return viewer.headset;
    },
    get connected() {
      return viewer.link.connected;
    },
    context: () => viewer.viewing.context(),
    hasHardware: () => viewer.viewing.hasHardware(),
    reconnect: () => viewer.link.reopen(),
    taken: (message) => {
      viewer.link.acknowledge(message.id);
      viewer.statistics.drawn(message, performance.now());
      events.drawn(message);
    },
    unreadable: (error) => viewer.link.unreadable(error),
    note: (text) => events.note(text, 'info'),
  };
}

interface Company {
  camera: Camera;
  readonly link: Connection;
  readonly welcome: Welcome | undefined;
  readonly drawing: { readonly shown: boolean };
}

export function peopleHost(viewer: Company, events: ViewerEvents): PeopleHost {
  return {
    get camera() {
      return viewer.camera;
    },
    set camera(value) {
      viewer.camera = value;
    },
    get welcome() {
      return viewer.welcome;
    },
    get drawsHere() {
      return viewer.drawing.shown;
    },
    send: (message) => viewer.link.sendMessage(message),
    told: () => events.people(),
  };
}
