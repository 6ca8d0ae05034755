// Handles: places of the scene that are dragged in the picture. The maths, which uses nothing of the page.
import { pixelsPerMetre, toView } from './box';
import type { Eye, Point } from './box';
import { MIN_DISTANCE, add, axes, clamp, dot, metresPerPixel, scale, subtract } from './camera';
import type { Camera } from './camera';
import type { Vec3 } from './protocol';

// A place that this viewer may move.
export interface Handle {
  path: string; // of the setting that it is: light[2].position
  name: string; // for people: Light 3
  at: Vec3; // m
  lowest: number; // of each coordinate
  highest: number;
}

// One of a list's: the chosen one is a ring, the others are dots.
export interface Choosable extends Handle {
  chosen: boolean;
  choose(): void;
}

export interface Lens {
  camera: Camera;
  fovY: number;
  height: number; // of the picture, pixels
}

// Part of the distance to the eye that a place moves when the cursor moves up by one pixel.
const ALONG_PER_PIXEL = 0.005;

// Where a place is seen in a picture of that size; undefined if it lies behind the eye or beside the picture.
export function handleAt(place: Vec3, eye: Eye, width: number, height: number): Point | undefined {
  const seen = toView(eye, place);
  if (!(seen[2] < -MIN_DISTANCE)) return undefined;
  const pixels = pixelsPerMetre(eye, height) / -seen[2];
  const [x, y] = [width / 2 + seen[0] * pixels, height / 2 - seen[1] * pixels];
  return x >= 0 && x <= width && y >= 0 && y <= height ? { x, y } : undefined;
}

// Where the place is after the cursor has moved by `step` pixels: in the plane through it that faces the camera, so
// that it stays below the cursor. `along`: on the line from the eye through it, upward is away.
export function dragged(place: Vec3, { camera, fovY, height }: Lens, step: Point, along: boolean): Vec3 {
  const { right, up, forward } = axes(camera);
  const away = subtract(place, camera.position);
  if (along) {
    const distance = Math.hypot(...away);
    if (!(distance > 0)) return place;
    const wanted = Math.max(MIN_DISTANCE, distance * Math.exp(-step.y * ALONG_PER_PIXEL));
    return add(camera.position, scale(away, wanted / distance));
  }
  const distance = Math.max(dot(away, forward), MIN_DISTANCE);
  const metres = metresPerPixel({ ...camera, distance }, fovY, height);
  return add(place, add(scale(right, step.x * metres), scale(up, -step.y * metres)));
}

export const within = (place: Vec3, { lowest, highest }: Pick<Handle, 'lowest' | 'highest'>): Vec3 => [
  clamp(place[0], lowest, highest),
  clamp(place[1], lowest, highest),
  clamp(place[2], lowest, highest),
];

// How old the places are that the server told last. It tells lists only when they are changed, and lights that go
// round do so in between, unless the scene is paused.
export class Age {
  private seconds = 0; // at the last report
  private tick = 0n; // of that report
  private paused = true;

  constructor(private readonly tickHz = 60) {}

  // A report has come. `anew`: it has the lists.
  report(tick: bigint, paused: boolean, anew: boolean): void {
    this.seconds = anew ? 0 : this.at(tick);
    this.tick = tick;
    this.paused = paused;
  }

  // In a picture of that tick, which may be older than the report.
  at(tick: bigint): number {
    return this.paused ? this.seconds : Math.max(0, this.seconds + Number(tick - this.tick) / this.tickHz);
  }
}
