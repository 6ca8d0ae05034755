// A viewer's state, read-only, for tests and for people who look into the page: window.brume, or report of a
// <brume-view>.
import type { Camera } from './camera';
import type { LinkState } from './connection';
import type { Drawing } from './drawing';
import type { Headset } from './headset';
import type { SceneState, Welcome } from './protocol';
import type { Values } from './shared-settings';
import { hash } from './statistics';
import type { Statistics } from './statistics';
import type { Viewing } from './viewing';

// What is told of a viewer; a Viewer has it all.
interface Sources {
  readonly statistics: Statistics;
  readonly viewing: Viewing;
  readonly drawing: Drawing;
  readonly linkState: LinkState['name'];
  readonly welcome: Welcome | undefined;
  readonly sentPose: number | undefined;
  readonly camera: Camera;
  readonly scene: SceneState | undefined;
  readonly values: Values;
  readonly headset: Headset | undefined;
}

export type Report = ReturnType<typeof report>;

export function report(of: Sources) {
  const { statistics, viewing } = of;
  return Object.freeze({
    get state() {
      return of.linkState;
    },
    get viewer() {
      return of.welcome?.viewer;
    },
    get tick() {
      return statistics.last && Number(statistics.last.tick);
    },
    get stateHash() {
      return statistics.last && hash(statistics.last.stateHash);
    },
    get frames() {
      return statistics.frames;
    },
    get sentPose() {
      return of.sentPose;
    },
    get recent() {
      return statistics.recent.map((entry) => ({ ...entry }));
    },
    get camera() {
      return { ...of.camera };
    },
    get scene() {
      const { scene } = of;
      const settings = Object.fromEntries(of.values); // by path
      return scene && { ...scene, settings, tick: Number(scene.tick), stateHash: hash(scene.stateHash) };
    },
    get lastFrame() {
      const { lastFrame, lastLatency } = statistics;
      if (!lastFrame) return undefined;
      const {
        id,
        tick,
        stateHash,
        poseSeq,
        orientation,
        fovY,
        width,
        height,
        quality,
        stages,
        jpeg,
        frusta,
        measured,
        layers,
      } = lastFrame;
      const bytes = jpeg.reduce((sum, view) => sum + view.length, 0);
      const shown = {
        id,
        tick: Number(tick),
        stateHash: hash(stateHash),
        poseSeq,
        width,
        height,
        quality,
        fovY,
        bytes,
        frusta,
      };
      return {
        ...shown,
        orientation,
        views: jpeg.length,
        layers: layers?.[0]?.count, // with depth; undefined: none came
        stages: { ...stages },
        measured: measured && { ...measured },
        latency: lastLatency && { ...lastLatency },
      };
    },
    // The 50th, 95th and 99th percentile of each stage.
    get latency() {
      return statistics.percentiles();
    },
    get reprojection() {
      return viewing.reprojection;
    },
    // Who draws what is shown.
    get drawing(): 'client' | 'server' {
      return of.drawing.shown ? 'client' : 'server';
    },
    // Of what is drawn here; undefined: the server's pictures are shown. gpuMs: undefined where it is not known.
    get drawn() {
      const { drawn, newest } = of.drawing;
      return (
        drawn &&
        newest && {
          ...drawn,
          ageMs: newest.ageMs,
          predicted: newest.predicted,
          measured: newest.measured && { ...newest.measured },
        }
      );
    },
    // The pose that the screen shows now, and the one that its picture was made for.
    get shown() {
      if (!viewing.shown) return undefined;
      const { position, orientation, made, part } = viewing.shown;
      return { position, orientation, part, made: { position: made.position, orientation: made.orientation } };
    },
    get headset() {
      const { headset } = of;
      return headset && { drawn: headset.drawn, asked: headset.asked };
    },
  });
}
