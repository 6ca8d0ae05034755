// Where the camera will be when the picture of a pose that is sent now is seen, by how it moved in the last moments.
import { clamp } from './camera';
import type { Camera } from './camera';

const SPAN_MS = 80; // of the movement that is taken into account: longer lags behind, shorter follows single events
const LEAST_MS = 12;
// Nobody's hand keeps its course for longer.
const LONGEST_MS = 150;

export class Predictor {
  private readonly past: { at: number; camera: Camera }[] = [];

  // Once per animation frame; ms of one clock, growing.
  add(at: number, camera: Camera): void {
    this.past.push({ at, camera });
    while (this.past.length > 2 && at - (this.past[1]?.at ?? at) >= SPAN_MS) this.past.shift();
  }

  // `ahead` ms after the newest; the newest itself where too little is known.
  predict(ahead: number): Camera | undefined {
    const first = this.past[0];
    const last = this.past[this.past.length - 1];
    if (!first || !last || last.at - first.at < LEAST_MS) return last?.camera;
    const part = clamp(ahead, 0, LONGEST_MS) / (last.at - first.at);
    const [from, to] = [first.camera, last.camera];
    const turn = Math.atan2(Math.sin(to.yaw - from.yaw), Math.cos(to.yaw - from.yaw));
    return {
      position: [
        to.position[0] + (to.position[0] - from.position[0]) * part,
        to.position[1] + (to.position[1] - from.position[1]) * part,
        to.position[2] + (to.position[2] - from.position[2]) * part,
      ],
      yaw: to.yaw + turn * part,
      pitch: to.pitch + (to.pitch - from.pitch) * part,
      distance: to.distance,
    };
  }

  reset(): void {
    this.past.length = 0;
  }
}
