// The method and settings that the server renders with, and the error of its pictures, each in one line of text.
import type { Frame, LitParticles, Measured, Plan } from './protocol';

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

// `broken`: true if the error is larger than promised, by its lower bound.
export interface ErrorLine {
  text: string;
  broken: boolean;
}

// Of what is shown: the server's picture, or what is drawn here, whose error the server's plan does not say.
export function shownError(shown: Frame | LitParticles | undefined, plan: Plan | undefined): ErrorLine | undefined {
  if (shown?.kind !== 'lit') return errorLine(shown?.measured, plan);
  return errorLine(shown.measured, plan && { ...plan, error: shown.predicted ?? 1 });
}

// What is measured, or else what is predicted. Undefined: neither is known.
export function errorLine(measured: Measured | undefined, plan: Plan | undefined): ErrorLine | undefined {
  const promised = plan?.promised;
  const end = promised === undefined ? '' : `, promised ${percent(promised)}`;
  if (measured) {
    const bound = (part: number): string => percent(part).replace(' %', '');
    const text = `${percent(measured.error)} (${bound(measured.low)}–${bound(measured.high)})${end}`;
    return { text, broken: promised !== undefined && measured.low > promised };
  }
  if (!plan || plan.error >= 1) return undefined;
  return { text: `${percent(plan.error)} predicted${end}`, broken: false };
}
