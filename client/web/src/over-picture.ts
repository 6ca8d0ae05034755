// Draws over the picture: the medium's box with a scale, and people.
import { beginLines, drawBox } from './box';
import type { Eye } from './box';
import type { People } from './people';
import { PeopleDrawing } from './people-drawing';
import type { Area } from './people-drawing';
import type { Frame, LitParticles, SceneState } from './protocol';

export interface OverHost {
  readonly viewing: { readonly shown: Omit<Eye, 'fovY'> | undefined; readonly parts: 1 | 2 };
  readonly statistics: { readonly last: Frame | LitParticles | undefined };
  readonly fovY: number;
  readonly wishes: { readonly box: boolean };
  readonly scene: SceneState | undefined;
  readonly people: People;
}

// The part of a place that a picture covers which is shown whole.
function areaOf(width: number, height: number, aspect: number): Area {
  const across = Math.min(width, height * aspect);
  const down = across / aspect;
  return { x: (width - across) / 2, y: (height - down) / 2, width: across, height: down };
}

export class OverPicture {
  private readonly drawing = new PeopleDrawing();

  constructor(
    private readonly picture: HTMLElement,
    private readonly canvas: HTMLCanvasElement, // above it
  ) {}

  // To be called once per animation frame.
  draw({ viewing, statistics, fovY, wishes, scene, people }: OverHost): void {
    const { canvas } = this;
    const { shown, parts } = viewing;
    const { last } = statistics;
    const led = last?.kind === 'frame' && last.follows !== 0 ? last : undefined; // with the size of another's picture
    this.picture.classList.toggle('whole', led !== undefined);
    const box = wishes.box ? scene?.box : undefined;
    const all = people.now.people;
    const some = all.some(({ pointer, look }) => pointer ?? (people.showsCameras && look));
    canvas.hidden = !shown || parts === 2 || (!box && !some);
    const lines = canvas.hidden ? undefined : beginLines(canvas, window.devicePixelRatio);
    if (!lines || !shown) return;
    const { context, width, height } = lines;
    const eye = { position: shown.position, orientation: shown.orientation, fovY: led?.fovY ?? fovY };
    const above = Number.parseFloat(getComputedStyle(canvas).getPropertyValue('--brume-scale-above')) || 0;
    if (box) drawBox(lines, box, eye, above);
    const area = led ? areaOf(width, height, led.width / led.height) : { x: 0, y: 0, width, height };
    this.drawing.draw(context, all, people.me?.id ?? 0, eye, area, people.showsCameras);
  }
}
