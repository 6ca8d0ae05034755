// The panel's controls. Each shows the server's value, except while the viewer changes it: then it shows the viewer's.
import { el, setText } from './dom';

// Least time between two messages of one control. The last change is always sent.
const SEND_MS = 50;
// How long a control ignores the server's value after the viewer's last change: reports that are on their way hold
// the old one.
export const HOLD_MS = 700;

export interface Field<T> {
  readonly element: HTMLElement;
  follow(value: T): void;
}

// Knows whether the viewer changes a control now, or did so just before.
class Hold {
  private pressed = false;
  private touchedAt = -Infinity;

  constructor(input: HTMLElement) {
    input.addEventListener('pointerdown', () => (this.pressed = true));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture', 'blur'] as const) {
      input.addEventListener(end, () => (this.pressed = false));
    }
  }

  touch(): void {
    this.touchedAt = performance.now();
  }

  get held(): boolean {
    return this.pressed || performance.now() - this.touchedAt < HOLD_MS;
  }
}

export function throttled<T>(send: (value: T) => void): (value: T) => void {
  let timer: number | undefined;
  let sentAt = -Infinity;
  let latest: T;
  const flush = (): void => {
    timer = undefined;
    sentAt = performance.now();
    send(latest);
  };
  return (value) => {
    latest = value;
    if (timer !== undefined) return;
    const wait = SEND_MS - (performance.now() - sentAt);
    if (wait <= 0) flush();
    else timer = window.setTimeout(flush, wait);
  };
}

// The value shown beside a control. It is hidden from screen readers, which read the control's own value.
const valueText = (): HTMLElement => el('span', { class: 'value', 'aria-hidden': 'true' });

function row(label: string, input: HTMLElement, output?: HTMLElement, hint?: string): HTMLElement {
  const element = el('label', { class: 'field', ...(hint && { title: hint }) }, el('span', {}, label));
  if (output) element.append(output);
  element.append(input);
  return element;
}

export interface SliderOptions {
  label: string;
  min: number;
  max: number;
  step: number;
  logarithmic?: boolean; // min must be positive
  grows?: boolean; // true: a value beyond max extends the slider
  format?: (value: number) => string;
  hint?: string;
  change: (value: number) => void;
}

const LOG_STEPS = 400;

export function slider(options: SliderOptions): Field<number> {
  const { min, logarithmic } = options;
  let max = options.max;
  const format = options.format ?? ((value: number): string => String(Math.round(value * 100) / 100));
  const input = el('input', { type: 'range' });
  const output = valueText();
  const hold = new Hold(input);
  const send = throttled(options.change);
  const toValue = (): number =>
    logarithmic ? min * (max / min) ** (Number(input.value) / LOG_STEPS) : Number(input.value);
  const paint = (): void => {
    const span = Number(input.max) - Number(input.min);
    const part = span > 0 ? (Number(input.value) - Number(input.min)) / span : 0;
    input.style.setProperty('--part', `${(part * 100).toFixed(1)}%`);
  };
  const place = (value: number): void => {
    if (options.grows && value > max) bounds(2 * value);
    const spot = logarithmic ? (LOG_STEPS * Math.log(Math.max(value, min) / min)) / Math.log(max / min) : value;
    input.value = String(spot);
    tell(value);
    paint();
  };
  const tell = (value: number): void => {
    setText(output, format(value));
    input.setAttribute('aria-valuetext', format(value));
  };
  const bounds = (most: number): void => {
    max = most;
    input.min = logarithmic ? '0' : String(min);
    input.max = logarithmic ? String(LOG_STEPS) : String(max);
    input.step = logarithmic ? '1' : String(options.step);
    paint();
  };
  bounds(max);
  input.addEventListener('input', () => {
    hold.touch();
    const value = toValue();
    tell(value);
    paint();
    send(value);
  });
  const element = row(options.label, input, output, options.hint);
  return {
    element,
    follow: (value) => hold.held || place(value),
  };
}

export function colour(label: string, change: (hex: string) => void, hint?: string): Field<string> {
  const input = el('input', { type: 'color' });
  const output = valueText();
  const hold = new Hold(input);
  const send = throttled(change);
  input.addEventListener('input', () => {
    hold.touch();
    setText(output, input.value);
    send(input.value);
  });
  const element = row(label, input, output, hint);
  element.classList.add('tinted');
  return {
    element,
    follow: (hex) => {
      // While the browser's colour dialogue is open, it has the focus.
      if (hold.held || input.value === hex) return;
      input.value = hex;
      setText(output, hex);
    },
  };
}

export function toggle(label: string, change: (on: boolean) => void, hint?: string): Field<boolean> {
  const input = el('input', { type: 'checkbox' });
  const hold = new Hold(input);
  input.addEventListener('change', () => {
    hold.touch();
    change(input.checked);
  });
  const element = row(label, input, undefined, hint);
  element.classList.add('inline');
  return {
    element,
    follow: (on) => {
      if (!hold.held) input.checked = on;
    },
  };
}

export interface Option {
  value: string;
  text: string;
}

export function select(
  label: string,
  change: (value: string) => void,
  hint?: string,
): Field<string> & { options(list: Option[]): void; follow(value: string, atOnce?: boolean): void } {
  const input = el('select');
  const hold = new Hold(input);
  input.addEventListener('change', () => {
    hold.touch();
    change(input.value);
  });
  const element = row(label, input, undefined, hint);
  element.classList.add('inline');
  return {
    element,
    // `atOnce`: also while the viewer is at it.
    follow: (value, atOnce = false) => {
      if (!atOnce && (hold.held || document.activeElement === input)) return;
      if (input.value === value) return;
      input.value = value;
    },
    options: (list) => {
      input.replaceChildren(...list.map(({ value, text }) => el('option', { value }, text)));
    },
  };
}

export function group(title: string, open: boolean, ...children: Node[]): HTMLDetailsElement {
  const details = el('details', {}, el('summary', {}, title), el('div', { class: 'fields' }, ...children));
  details.open = open;
  return details;
}

export function button(text: string, title: string, press: () => void): HTMLButtonElement {
  const element = el('button', { type: 'button', title }, text);
  element.addEventListener('click', press);
  return element;
}
