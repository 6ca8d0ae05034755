// The method and settings that the server renders with, in one line of text.
import type { Plan } from './protocol';

// A percentage with two digits: 0.3 %, 1.5 %, 12 %.
const percent = (part: number): string => `${Number((100 * part).toPrecision(2))} %`;

// 1, the error of a black picture, stands for one that the server does not predict.
const errorText = (error: number): string => (error < 1 ? percent(error) : 'error not predicted');

// `asked`: the method that the scene names. Empty for a server that sends no plan.
export function planText(asked: string | undefined, plan: Plan | undefined): string {
  if (!plan) return '';
  const words = [plan.text || plan.method, errorText(plan.error)];
  if (plan.relaxed > 0) words.push(`relaxed ${plan.relaxed}`);
  return (asked === 'auto' ? 'auto: ' : '') + words.join(', ');
}
