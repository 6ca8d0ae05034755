// Decides whether a view counts as hidden: once nobody has seen it for two seconds, until somebody sees it again.
const PATIENCE_MS = 2000; // so that a look at another tab does not stop the pictures

export class Visibility {
  hidden = false;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly changed: () => void) {}

  // To be called at every visibilitychange, with document.hidden.
  update(notSeen: boolean): void {
    clearTimeout(this.timer);
    if (notSeen) this.timer = setTimeout(() => this.set(true), PATIENCE_MS);
    else this.set(false);
  }

  private set(hidden: boolean): void {
    if (hidden === this.hidden) return;
    this.hidden = hidden;
    this.changed();
  }
}

// Says whether somebody can see the surface: its page is not hidden, and it is not scrolled out of the window.
export function watchSight(surface: HTMLElement, ending: AbortSignal, changed: (seen: boolean) => void): void {
  let inWindow = true;
  const tell = (): void => changed(!document.hidden && inWindow);
  document.addEventListener('visibilitychange', tell, { signal: ending });
  const observer = new IntersectionObserver((entries) => {
    inWindow = entries[entries.length - 1]?.isIntersecting ?? true;
    tell();
  });
  observer.observe(surface);
  tell(); // a page that opens hidden gets no event: without this the server would never hear of it
  ending.addEventListener('abort', () => observer.disconnect());
}
