// The passes of lit-medium.ts as GLSL: what each program is made of. The formulas are the server's.
import compose from './glsl/compose.frag.glsl?glsl';
import meanSource from './glsl/mean_source.glsl?glsl';
import onRay from './glsl/on_ray.glsl?glsl';
import particle from './glsl/particle.vert.glsl?glsl';
import parts from './glsl/parts.glsl?glsl';
import physics from './glsl/physics.glsl?glsl';
import places from './glsl/places.frag.glsl?glsl';
import range from './glsl/range.frag.glsl?glsl';
import ray from './glsl/ray.glsl?glsl';
import rays from './glsl/rays.frag.glsl?glsl';
import shadowFragment from './glsl/shadow.frag.glsl?glsl';
import shadowVertex from './glsl/shadow.vert.glsl?glsl';
import sky from './glsl/sky.glsl?glsl';
import slabs from './glsl/slabs.frag.glsl?glsl';
import spline from './glsl/spline.frag.glsl?glsl';
import surfaces from './glsl/surfaces.frag.glsl?glsl';
import type { Layout } from './lit-moment';

export const SLABS = 8; // along every ray
export const MARGIN = 3; // rays of the grid before the picture: a spline's values and coefficients need one and two

// One triangle that covers the viewport.
export const WHOLE = `void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}`;

export interface Source {
  vertex: string;
  fragment: string;
}

export function source(
  defines: Record<string, number>,
  vertex: readonly string[],
  fragment: readonly string[],
): Source {
  const lines = Object.entries({ SLABS, MARGIN, ...defines }).map(([name, value]) => `#define ${name} ${value}`);
  const precise = ['float', 'int', 'sampler2D', 'sampler2DArray'].map((type) => `precision highp ${type};`);
  const head = ['#version 300 es', ...precise, ...lines, physics].join('\n');
  const text = (parts: readonly string[]): string => [head, ...parts].join('\n');
  return { vertex: text(vertex), fragment: text(fragment) };
}

export const rangeSource = (): Source => source({}, [particle], [ray, onRay, range]);
export const placesSource = (): Source => source({}, [WHOLE], [ray, places]);

// Slabs first, first + 1 ... of `count`, each drawn into a target of its own.
export const slabsSource = ({ hues, fluences }: Layout, first: number, count: number): Source =>
  source({ HUES: hues, FLUENCES: fluences, FIRST: first, COUNT: count }, [particle], [parts, ray, onRay, slabs]);

// The light up to the end of slabs first, first + 1 ... of `count`.
export const raysSource = (first: number, count: number): Source =>
  source({ FIRST: first, COUNT: count }, [WHOLE], [meanSource, parts, rays]);

// Coefficients of layers first, first + 1 ... of `count`.
export const splineSource = (first: number, count: number): Source =>
  source({ FIRST: first, COUNT: count }, [WHOLE], [parts, spline]);

export const shadowSource = (): Source => source({}, [shadowVertex], [shadowFragment]);
export const surfacesSource = (): Source => source({}, [WHOLE], [ray, sky, meanSource, surfaces]);

// `behind`: true where surfaces were drawn. `linear`: light and transmittance, rather than what a display shows.
export const composeSource = (behind: boolean, linear: boolean): Source =>
  source(
    { ...(behind ? { SURFACES: 1 } : {}), ...(linear ? { LINEAR: 1 } : {}) },
    [WHOLE],
    [ray, sky, meanSource, compose],
  );
