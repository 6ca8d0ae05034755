// The medium's box, a scale bar and the axes, drawn over the picture. The lines are computed without a page.
import { add, scale, subtract } from './camera';
import { rotate } from './projection';
import type { Box, Quat, Vec3 } from './protocol';

export interface Eye {
  position: Vec3;
  orientation: Quat;
  fovY: number;
}
export interface Point {
  x: number; // pixels from the left
  y: number; // pixels from the top
}
export interface Edge {
  from: Point;
  to: Point;
  behind: boolean; // true: it meets the corner that is furthest from the eye
}

const NEAR = 0.01; // m before the eye where lines are cut off
const conjugate = ([x, y, z, w]: Quat): Quat => [-x, -y, -z, w];

// The place as the eye sees it: +X right, +Y up, -Z ahead.
export function toView(eye: Eye, point: Vec3): Vec3 {
  return rotate(conjugate(eye.orientation), subtract(point, eye.position));
}

// Pixels that a metre covers at the depth of one metre.
export const pixelsPerMetre = (eye: Eye, height: number): number => height / (2 * Math.tan(eye.fovY / 2));

export const cornersOf = ({ lo, hi }: Box): Vec3[] =>
  Array.from({ length: 8 }, (_, i) => [i & 1 ? hi[0] : lo[0], i & 2 ? hi[1] : lo[1], i & 4 ? hi[2] : lo[2]]);

// The box's edges in a picture of that size, without what lies behind the eye.
export function edgesOf(box: Box, eye: Eye, width: number, height: number): Edge[] {
  const seen = cornersOf(box).map((corner) => toView(eye, corner));
  const far = seen.reduce((best, one, i) => (Math.hypot(...one) > Math.hypot(...(seen[best] ?? one)) ? i : best), 0);
  const pixels = pixelsPerMetre(eye, height);
  const project = (p: Vec3): Point => ({
    x: width / 2 - (p[0] / p[2]) * pixels,
    y: height / 2 + (p[1] / p[2]) * pixels,
  });
  const edges: Edge[] = [];
  for (let i = 0; i < 8; ++i)
    for (const bit of [1, 2, 4]) {
      if (i & bit) continue;
      let [a, b] = [seen[i], seen[i | bit]];
      if (!a || !b) continue;
      if (a[2] > -NEAR && b[2] > -NEAR) continue;
      const cut = (inside: Vec3, outside: Vec3): Vec3 =>
        add(inside, scale(subtract(outside, inside), (-NEAR - inside[2]) / (outside[2] - inside[2])));
      if (a[2] > -NEAR) a = cut(b, a);
      else if (b[2] > -NEAR) b = cut(a, b);
      edges.push({ from: project(a), to: project(b), behind: i === far || (i | bit) === far });
    }
  return edges;
}

// The scale at the depth of the box's middle: a round length of 1, 2 or 5 times a power of ten that is at most a
// quarter of the picture wide. Undefined while the middle is behind the eye.
export function barOf(
  box: Box,
  eye: Eye,
  width: number,
  height: number,
): { metres: number; pixels: number } | undefined {
  const depth = -toView(eye, scale(add(box.lo, box.hi), 0.5))[2];
  if (!(depth > NEAR)) return undefined;
  const perMetre = pixelsPerMetre(eye, height) / depth;
  const most = width / 4 / perMetre;
  const decade = 10 ** Math.floor(Math.log10(most));
  const metres = ([5, 2, 1].find((times) => times * decade <= most) ?? 1) * decade;
  return { metres, pixels: metres * perMetre };
}

// Lengths with their unit, in at most three digits: 5 m, 13.8 × 13.8 × 7 m, 2 km.
export function lengthText(...metres: readonly number[]): string {
  const most = Math.max(...metres);
  const [unit, factor] = most >= 1000 ? ['km', 1e-3] : most < 0.1 ? ['mm', 1e3] : ['m', 1];
  return `${metres.map((one) => Number((one * factor).toPrecision(3))).join(' × ')} ${unit}`;
}

// The world's axes as the eye sees their directions, around `middle`. Those that point away from the eye come first, as
// they are behind the others. `toward`: it points to the eye, or to neither side.
export function axesOf(eye: Eye, middle: Point, length: number): { name: string; tip: Point; toward: boolean }[] {
  const directions: [string, Vec3][] = [
    ['x', [1, 0, 0]],
    ['y', [0, 1, 0]],
    ['z', [0, 0, 1]],
  ];
  return directions
    .map(([name, axis]) => ({ name, seen: rotate(conjugate(eye.orientation), axis) }))
    .sort((a, b) => a.seen[2] - b.seen[2])
    .map(({ name, seen: [x, y, z] }) => ({
      name,
      tip: { x: middle.x + length * x, y: middle.y - length * y },
      toward: z >= -1e-9,
    }));
}

const AXES = { right: 56, above: 56, length: 34 }; // CSS pixels
const BAR = { left: 18, above: 18, tick: 5 }; // CSS pixels

export interface Lines {
  context: CanvasRenderingContext2D; // in CSS pixels
  width: number;
  height: number;
}

// Clears a canvas that lies over the picture. `ratio`: its pixels in one of the page's.
export function beginLines(canvas: HTMLCanvasElement, ratio: number): Lines | undefined {
  const context = canvas.getContext('2d');
  if (!context) return undefined;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const [across, down] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== across || canvas.height !== down) Object.assign(canvas, { width: across, height: down });
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

// Draws box, scale and axes on a canvas that beginLines() has cleared, the scale `above` CSS pixels over its usual place.
export function drawBox(lines: Lines, box: Box, eye: Eye, above: number): void {
  drawFigure(lines.context, lines, box, eye, above);
}

// The same on what is there. `context` counts in CSS pixels; `above`: the part of the height, from below, to leave out.
export function drawFigure(
  context: CanvasRenderingContext2D,
  { width, height }: { width: number; height: number },
  box: Box,
  eye: Eye,
  above: number,
): void {
  // Light lines on a dark rim are seen on sky and on cloud.
  const stroke = (path: Path2D, faint: boolean): void => {
    context.setLineDash(faint ? [4, 5] : []);
    for (const [colour, thick] of [
      ['rgb(11 15 20 / 45%)', 3],
      [faint ? 'rgb(255 255 255 / 55%)' : 'rgb(255 255 255 / 92%)', 1.6],
    ] as const) {
      Object.assign(context, { strokeStyle: colour, lineWidth: thick });
      context.stroke(path);
    }
  };
  for (const { from, to, behind } of edgesOf(box, eye, width, height)) {
    const path = new Path2D();
    path.moveTo(from.x, from.y);
    path.lineTo(to.x, to.y);
    stroke(path, behind);
  }
  const label = (text: string, x: number, y: number): void => {
    context.setLineDash([]);
    Object.assign(context, { font: '12px system-ui, sans-serif', lineWidth: 3, lineJoin: 'round' });
    Object.assign(context, { strokeStyle: 'rgb(11 15 20 / 70%)', fillStyle: '#fff' });
    context.strokeText(text, x, y);
    context.fillText(text, x, y);
  };
  const middle = { x: width - AXES.right, y: height - AXES.above - above };
  for (const { name, tip, toward } of axesOf(eye, middle, AXES.length)) {
    const path = new Path2D();
    path.moveTo(middle.x, middle.y);
    path.lineTo(tip.x, tip.y);
    stroke(path, !toward);
    label(name, tip.x + Math.sign(tip.x - middle.x) * 6 - 3, tip.y + (tip.y < middle.y ? -5 : 13));
  }
  const bar = barOf(box, eye, width, height);
  if (!bar) return;
  const [x, y] = [BAR.left, height - BAR.above - above];
  const path = new Path2D();
  path.moveTo(x, y - BAR.tick);
  path.lineTo(x, y);
  path.lineTo(x + bar.pixels, y);
  path.lineTo(x + bar.pixels, y - BAR.tick);
  stroke(path, false);
  const lines = [lengthText(...subtract(box.hi, box.lo)), lengthText(bar.metres)];
  lines.forEach((text, i) => {
    const at = y - 10 - 17 * (lines.length - 1 - i);
    label(text, x, at);
  });
}
