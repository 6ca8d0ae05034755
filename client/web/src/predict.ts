// Predicts where the camera will be when the picture of a pose that is sent now is seen: it goes on as it moved just
// before.
import { clamp } from './camera';
import type { Camera } from './camera';

const SPAN_MS = 80; // of movement is extrapolated: more would lag behind, less would follow single events
const LEAST_MS = 12;
// Longest prediction: a hand changes its direction after that.
const LONGEST_MS = 150;

export class Predictor {
  private readonly past: { at: number; camera: Camera }[] = [];

  // To be called once per animation frame. `at`: ms, growing.
  add(at: number, camera: Camera): void {
    this.past.push({ at, camera });
    while (this.past.length > 2 && at - (this.past[1]?.at ?? at) >= SPAN_MS) this.past.shift();
  }

  // The camera `ahead` ms after the newest one that was added; the newest itself while too few are known.
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
