// Whether the page counts as hidden: two seconds after it stopped being seen, and no longer from the moment it is seen again.
const PATIENCE_MS = 2000; // a glance at another tab stops no pictures

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
