// Draws people over the picture: dots where they point, and small cones where they look from.
import { pixelsPerMetre, toView } from './box';
import type { Eye, Point } from './box';
import { coneOf } from './people';
import type { Person, Vec3 } from './protocol';

const NEAR = 0.01; // m before the eye; what is nearer is not drawn
const DOT = 6; // CSS pixels, radius
const CONE = 0.06; // its length, of the distance from the eye
const EASE_MS = 60; // in which a dot goes 63 % of the way to where it is now
const EDGES = [
  [0, 1],
  [0, 2],
  [0, 3],
  [0, 4],
  [1, 2],
  [2, 3],
  [3, 4],
  [4, 1],
] as const;

// The part of the canvas that the picture covers.
export interface Area {
  x: number;
  y: number;
  width: number;
  height: number;
}

// Where a place is seen; undefined: behind the eye.
export function seenAt(place: Vec3, eye: Eye, { x, y, width, height }: Area): Point | undefined {
  const [across, up, back] = toView(eye, place);
  if (back > -NEAR) return undefined;
  const pixels = pixelsPerMetre(eye, height);
  return { x: x + width / 2 - (across / back) * pixels, y: y + height / 2 + (up / back) * pixels };
}

// The edges of a person's cone, as they are seen. Its size is that of a thing `CONE` of the way to it.
export function coneSeen(look: NonNullable<Person['look']>, eye: Eye, area: Area): [Point, Point][] {
  const far = Math.hypot(...look.position.map((p, i) => p - (eye.position[i] ?? 0)));
  const corners = coneOf(look, CONE * far).map((corner) => seenAt(corner, eye, area));
  return EDGES.flatMap(([a, b]) => {
    const [from, to] = [corners[a], corners[b]];
    return from && to ? [[from, to] as [Point, Point]] : [];
  });
}

export class PeopleDrawing {
  private readonly dots = new Map<number, Vec3>(); // by person, as they were drawn last
  private before = 0; // ms

  // `others`: not this viewer, but for its own dot; `cones`: true to draw them.
  draw(context: CanvasRenderingContext2D, people: readonly Person[], me: number, eye: Eye, area: Area, cones: boolean) {
    const now = performance.now();
    const part = 1 - Math.exp(-(now - this.before) / EASE_MS);
    this.before = now;
    for (const person of people) {
      if (cones && person.id !== me && person.look) this.cone(context, person, person.look, eye, area);
      this.dot(context, person, eye, area, part);
    }
    for (const id of this.dots.keys()) if (!people.some((one) => one.id === id && one.pointer)) this.dots.delete(id);
  }

  private cone(
    context: CanvasRenderingContext2D,
    { colour, name }: Person,
    look: NonNullable<Person['look']>,
    eye: Eye,
    area: Area,
  ): void {
    const edges = coneSeen(look, eye, area);
    if (edges.length < EDGES.length) return;
    const path = new Path2D();
    for (const [from, to] of edges) {
      path.moveTo(from.x, from.y);
      path.lineTo(to.x, to.y);
    }
    for (const [style, width] of [
      ['rgb(11 15 20 / 55%)', 3.5],
      [colour, 1.6],
    ] as const) {
      Object.assign(context, { strokeStyle: style, lineWidth: width });
      context.stroke(path);
    }
    const top = edges.reduce((best, [, to]) => (to.y < best.y ? to : best), edges[0]?.[1] ?? { x: 0, y: 0 });
    label(context, name, colour, { x: top.x, y: top.y - 6 });
  }

  private dot(context: CanvasRenderingContext2D, person: Person, eye: Eye, area: Area, part: number): void {
    const { id, pointer, colour, name } = person;
    if (!pointer) return;
    const last = this.dots.get(id) ?? pointer;
    const place = last.map((x, i) => x + part * ((pointer[i] ?? 0) - x)) as unknown as Vec3;
    this.dots.set(id, place);
    const at = seenAt(place, eye, area);
    if (!at) return;
    for (const [radius, style] of [
      [DOT + 3, 'rgb(11 15 20 / 60%)'],
      [DOT + 1.5, '#fff'],
      [DOT, colour],
    ] as const) {
      context.beginPath();
      context.arc(at.x, at.y, radius, 0, 2 * Math.PI);
      context.fillStyle = style;
      context.fill();
    }
    label(context, name, colour, { x: at.x, y: at.y - DOT - 8 });
  }
}

// A name is drawn as text on a canvas: nothing in it is markup.
function label(context: CanvasRenderingContext2D, name: string, colour: string, { x, y }: Point): void {
  Object.assign(context, { font: '600 12px system-ui, sans-serif', textAlign: 'center', lineJoin: 'round' });
  Object.assign(context, { lineWidth: 3.5, strokeStyle: 'rgb(11 15 20 / 80%)', fillStyle: colour });
  context.strokeText(name, x, y);
  context.fillText(name, x, y);
  context.textAlign = 'start';
}
