// The method and settings that the server renders with, in one line of text.
import type { SceneState } from './protocol';

// A percentage with two digits: 0.3 %, 1.5 %, 12 %.
const percent = (part: number): string => `${Number((100 * part).toPrecision(2))} %`;

// Empty for a server that sends no plan.
export function planText(scene: Pick<SceneState, 'method' | 'plan'>): string {
  const { plan, method } = scene;
  if (!plan) return '';
  const words = [plan.method];
  if (plan.quadrature !== '') words.push(plan.quadrature);
  if (plan.rate > 0) words.push(`${plan.rate} px`);
  if (plan.slabs > 0) words.push(`${plan.slabs} slabs`);
  words.push(percent(plan.error));
  if (plan.relaxed > 0) words.push(`relaxed ${plan.relaxed}`);
  return (method === 'auto' ? 'auto: ' : '') + words.join(', ');
}
