// Frusta of pictures, and homographies from one view to another. Uses no page and no WebGL.
// Matrices are 3x3, columns first, as WebGL takes them.
import { add, cross, dot, scale, subtract } from './camera';
import type { Box, Frustum, Quat, Vec3 } from './protocol';

export type Matrix3 = readonly number[]; // 9 numbers

// The pose of one eye and the frustum of its picture.
export interface View {
  position: Vec3;
  orientation: Quat; // world from view, unit
  frustum: Frustum;
}

// The symmetric frustum of a vertical angle `fovY` and an `aspect`, width / height.
export function symmetric(fovY: number, aspect: number): Frustum {
  const up = Math.tan(fovY / 2);
  return { left: up * aspect, right: up * aspect, up, down: up };
}

// The frustum, wider and higher by the factor 1 + `margin`, about its middle.
export function widened(f: Frustum, margin: number): Frustum {
  const x = ((f.left + f.right) * margin) / 2;
  const y = ((f.up + f.down) * margin) / 2;
  return { left: f.left + x, right: f.right + x, up: f.up + y, down: f.down + y };
}

// The frustum, widened about its middle in one direction, so that its width / height is `aspect`.
export function shaped(f: Frustum, aspect: number): Frustum {
  const across = f.left + f.right;
  const along = f.up + f.down;
  const x = Math.max(0, (along * aspect - across) / 2);
  const y = Math.max(0, (across / aspect - along) / 2);
  return { left: f.left + x, right: f.right + x, up: f.up + y, down: f.down + y };
}

// The frustum of a projection matrix of WebXR: clip from view, 4x4, columns first, looking down -Z.
export function fromProjection(m: ArrayLike<number>): Frustum {
  const [x, y, right, up] = [m[0] ?? 1, m[5] ?? 1, m[8] ?? 0, m[9] ?? 0];
  return { left: (1 - right) / x, right: (1 + right) / x, up: (1 + up) / y, down: (1 - up) / y };
}

// The frustum of an eye with the orientation `to` that covers all that `view` covers, as far as that lies in front of
// the eye.
export function covering(view: Pick<View, 'orientation' | 'frustum'>, to: Quat): Frustum {
  const turn = multiply(conjugate(to), view.orientation);
  const { left, right, up, down } = view.frustum;
  const corners = [-left, right].flatMap((x) => [-down, up].map((y) => rotate(turn, [x, y, -1])));
  const seen = corners.map((c) => {
    const depth = Math.max(0.1, -c[2]);
    return [c[0] / depth, c[1] / depth] as const;
  });
  const xs = seen.map(([x]) => x);
  const ys = seen.map(([, y]) => y);
  return { left: -Math.min(...xs), right: Math.max(...xs), up: Math.max(...ys), down: -Math.min(...ys) };
}

export const conjugate = (q: Quat): Quat => [-q[0], -q[1], -q[2], q[3]];

export function multiply(a: Quat, b: Quat): Quat {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2],
    a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

// The vector v turned by the unit quaternion q.
export function rotate(q: Quat, v: Vec3): Vec3 {
  const axis: Vec3 = [q[0], q[1], q[2]];
  const t = scale(cross(axis, v), 2);
  return add(add(v, scale(t, q[3])), cross(axis, t));
}

// The angle between two orientations, radians; exact to 1e-8 for two that are nearly equal.
export function angleBetween(a: Quat, b: Quat): number {
  const turn = multiply(conjugate(a), b);
  return 2 * Math.atan2(Math.hypot(turn[0], turn[1], turn[2]), Math.abs(turn[3]));
}

// The homography that finds each point of the view `shown` (-1 ... 1, right and up) in the picture of the view
// `made`, as homogeneous texture coordinates (0 ... 1, right and down). By default it is a rotation, which is right
// for distant things. With `depth` it is right for the plane that lies so far (m) ahead of `made`, although the eye
// has moved.
export function warp(made: View, shown: View, depth = Infinity): Matrix3 {
  const { left, right, up, down } = shown.frustum;
  const into = conjugate(made.orientation);
  const ahead = rotate(made.orientation, [0, 0, -1]);
  const moved = subtract(shown.position, made.position);
  const m = made.frustum;
  const column = (direction: Vec3): Vec3 => {
    const world = rotate(shown.orientation, direction);
    let seen = rotate(into, world);
    if (Number.isFinite(depth)) {
      const near = rotate(into, scale(moved, dot(world, ahead) / depth));
      seen = add(scale(seen, 1 - dot(moved, ahead) / depth), near);
    }
    const w = -seen[2];
    return [(m.left * w + seen[0]) / (m.left + m.right), (m.up * w - seen[1]) / (m.up + m.down), w];
  };
  return [
    ...column([(left + right) / 2, 0, 0]),
    ...column([0, (up + down) / 2, 0]),
    ...column([(right - left) / 2, (up - down) / 2, -1]),
  ];
}

// The frustum that covers both.
export function together(a: Frustum, b: Frustum): Frustum {
  const most = (side: keyof Frustum): number => Math.max(a[side], b[side]);
  return { left: most('left'), right: most('right'), up: most('up'), down: most('down') };
}

// The point (x, y), mapped by `matrix`; undefined if it lies behind the eye.
export function apply(matrix: Matrix3, x: number, y: number): readonly [u: number, v: number] | undefined {
  const at = (row: number): number => (matrix[row] ?? 0) * x + (matrix[row + 3] ?? 0) * y + (matrix[row + 6] ?? 0);
  const w = at(2);
  return w > 0 ? [at(0) / w, at(1) / w] : undefined;
}

// View depth of a box's middle, m. Infinite within the box and where it is not ahead: there is no one depth.
export function meanDepth(box: Box | undefined, { position, orientation }: Omit<View, 'frustum'>): number {
  if (!box) return Infinity;
  const { lo, hi } = box;
  const within = ([0, 1, 2] as const).every((i) => position[i] >= lo[i] && position[i] <= hi[i]);
  const depth = -rotate(conjugate(orientation), subtract(scale(add(lo, hi), 0.5), position))[2];
  return within || depth <= 0 ? Infinity : depth;
}
