// The library: import it, and <brume-view> is an element of the page.
import { BrumeView, defineBrumeView } from './brume-view';

export { BrumeView };
export type { BrumeViewEvents } from './brume-view';
export { SharedMedium } from './shared-medium';
export type { SharedCamera, SharedScene } from './shared-medium';

defineBrumeView();
