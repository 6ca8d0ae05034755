// The statistics overlay: frame rate, latency by stage, the scene, device times of the passes.
import { el, setText } from './dom';
import { STAGES } from './latency';
import type { Latency, Stage } from './latency';
import type { Drawing } from './drawing';
import { shownError } from './plan';
import { PERCENTILES } from './statistics';
import type { Percentiles } from './statistics';
import type { Frame, LitParticles, SceneState, Welcome } from './protocol';

export interface OverlayData {
  fps: number;
  bytesPerSecond: number;
  roundTripMs: number | undefined;
  latency: Readonly<Latency> | undefined;
  percentiles: Percentiles | undefined;
  shown: Frame | LitParticles | undefined; // what is drawn here, or a picture
  drawn: Drawing['drawn'];
  scene: SceneState | undefined;
  welcome: Welcome | undefined;
}

const STAGE_HINTS: Record<Stage, string> = {
  input: 'The page had the input and waited for its next animation frame',
  wait: 'The server had the pose and waited for its next tick',
  render: 'The device drew the picture',
  encode: 'JPEG',
  queue: 'The picture waited for the socket',
  network: 'What remains: the way there and back',
  decode: 'The browser decoded the JPEG',
  present: 'The browser brought it to the screen',
};
// Number of samples in the latency curve; each frame is one.
const HISTORY = 60;
const CURVE = { width: 132, height: 34 };

const ms = (value: number): string => (value < 99.95 ? value.toFixed(1) : value.toFixed(0));

export function formatBytes(bytesPerSecond: number): string {
  if (bytesPerSecond < 1e3) return `${bytesPerSecond.toFixed(0)} B/s`;
  if (bytesPerSecond < 1e6) return `${(bytesPerSecond / 1e3).toFixed(0)} kB/s`;
  return `${(bytesPerSecond / 1e6).toFixed(2)} MB/s`;
}

export class Overlay {
  private readonly fps = el('b');
  private readonly total = el('b');
  private readonly curve = el('canvas', { 'aria-hidden': 'true' });
  private readonly bar = el('div', { class: 'stack', 'aria-hidden': 'true' });
  private readonly stages = new Map<Stage, { part: HTMLElement; value: HTMLElement }>();
  private readonly facts = new Map<string, HTMLElement>();
  private readonly passes = el('dl', { class: 'passes' });
  private readonly passesTitle = el('h2', {}, 'GPU passes');
  private readonly gpu = el('dd');
  private readonly history: number[] = [];

  constructor(private readonly root: HTMLElement) {
    this.curve.width = CURVE.width * 2;
    this.curve.height = CURVE.height * 2;
    const legend = el('dl', { class: 'legend' });
    legend.append(el('div', {}, el('dt', {}, 'ms'), el('dd', {}, 'p50 · p95 · p99')));
    for (const stage of STAGES) {
      const part = el('i', { class: `stage-${stage}` });
      const value = el('dd');
      legend.append(el('div', { title: STAGE_HINTS[stage] }, el('dt', { class: `stage-${stage}` }, stage), value));
      this.bar.append(part);
      this.stages.set(stage, { part, value });
    }
    legend.append(
      el(
        'div',
        { title: 'The device’s own time, part of render; or this browser’s, where it draws' },
        el('dt', {}, 'gpu alone'),
        this.gpu,
      ),
    );
    const facts = el('dl', { class: 'facts' });
    for (const name of [
      'input to picture',
      'tick',
      'viewers',
      'particles',
      'method',
      'error',
      'picture',
      'stream',
      'round trip',
      'device',
    ]) {
      const value = el('dd', name === 'error' ? { class: 'whole' } : {});
      facts.append(el('div', {}, el('dt', {}, name), value));
      this.facts.set(name, value);
    }
    root.append(
      el(
        'div',
        { class: 'heads' },
        el('p', {}, this.fps, el('span', {}, 'frames/s')),
        el('p', {}, this.total, el('span', {}, 'ms input to picture')),
        this.curve,
      ),
      this.bar,
      legend,
      facts,
      this.passesTitle,
      this.passes,
    );
  }

  sample(latency: Latency): void {
    this.history.push(latency.total);
    if (this.history.length > HISTORY) this.history.shift();
  }

  // To be called a few times a second. Does nothing while the overlay is hidden.
  update(data: OverlayData): void {
    if (this.root.hidden) return;
    setText(this.fps, data.fps.toFixed(data.fps < 9.5 ? 1 : 0));
    setText(this.total, data.latency ? data.latency.total.toFixed(0) : '–');
    const { percentiles } = data;
    const spread = (key: Stage | 'total'): string | undefined =>
      percentiles && PERCENTILES.map((percent) => ms(percentiles[percent][key])).join(' · ');
    for (const [stage, { part, value }] of this.stages) {
      const amount = data.latency?.[stage];
      setText(value, spread(stage) ?? '–');
      part.style.flexGrow = String(amount ?? 0);
    }
    const total = spread('total');
    this.fact('input to picture', total && `${total} ms`);
    const { scene, shown, drawn, welcome } = data;
    const frame = shown?.kind === 'frame' ? shown : undefined;
    const gpu = frame ? frame.stages.gpu : drawn?.gpuMs;
    setText(this.gpu, gpu === undefined ? '–' : ms(gpu));
    this.fact('tick', scene && (shown ?? scene).tick.toLocaleString('en'));
    this.fact('viewers', scene && String(scene.viewers));
    this.fact('particles', scene && scene.particles.toLocaleString('en'));
    this.fact('method', scene?.plan && (scene.plan.text || scene.plan.method));
    const error = shownError(shown, scene?.plan);
    this.fact('error', error?.text, error?.broken);
    const here = drawn && `drawn here, ${drawn.proxies.toLocaleString('en')} particles, ${drawn.rays} rays`;
    this.fact('picture', frame ? `${frame.width}×${frame.height} q${frame.quality}` : here);
    this.fact('stream', formatBytes(data.bytesPerSecond));
    this.fact('round trip', data.roundTripMs === undefined ? undefined : `${ms(data.roundTripMs)} ms`);
    this.fact('device', welcome?.device);
    this.drawPasses(scene?.passes ?? []);
    this.drawCurve();
  }

  private fact(name: string, text: string | undefined, broken = false): void {
    const value = this.facts.get(name);
    if (!value) return;
    value.classList.toggle('broken', broken);
    setText(value, text ?? '–');
    value.title = text ?? '';
  }

  private drawPasses(passes: SceneState['passes']): void {
    this.passesTitle.hidden = passes.length === 0;
    while (this.passes.children.length > passes.length) this.passes.lastElementChild?.remove();
    while (this.passes.children.length < passes.length) this.passes.append(el('div', {}, el('dt'), el('dd')));
    const most = Math.max(1e-3, ...passes.map((pass) => pass.ms));
    passes.forEach((pass, index) => {
      const line = this.passes.children[index] as HTMLElement;
      if (line.children[0]) setText(line.children[0], pass.name);
      if (line.children[1]) setText(line.children[1], pass.ms.toFixed(2));
      line.style.setProperty('--part', `${((100 * pass.ms) / most).toFixed(1)}%`);
    });
  }

  private drawCurve(): void {
    const context = this.curve.getContext('2d');
    if (!context) return;
    const { width, height } = this.curve;
    context.clearRect(0, 0, width, height);
    if (this.history.length < 2) return;
    const most = Math.max(20, ...this.history) * 1.1;
    const x = (i: number): number => width - 3 - ((this.history.length - 1 - i) * (width - 6)) / (HISTORY - 1);
    const y = (value: number): number => height - 3 - (value / most) * (height - 6);
    context.beginPath();
    this.history.forEach((value, i) => context.lineTo(x(i), y(value)));
    context.strokeStyle = '#9cc4ee';
    context.lineWidth = 2.5;
    context.lineJoin = 'round';
    context.stroke();
    context.lineTo(x(this.history.length - 1), height);
    context.lineTo(x(0), height);
    context.fillStyle = 'rgb(156 196 238 / 14%)';
    context.fill();
  }
}
