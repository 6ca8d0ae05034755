// The view alone, for a frame of another page: embed.html?position=0,6,26&target=0,0,0&controls=look. Parameters are the
// attributes of <brume-view>.
import { BrumeView, defineBrumeView } from './brume-view';
import type { Report } from './report';
import { takeToken } from './role';

const view = document.querySelector('brume-view') as BrumeView;
const query = new URLSearchParams(location.search);
for (const name of BrumeView.observedAttributes) {
  const value = query.get(name);
  if (value !== null && name !== 'src' && !(name === 'predict' && value === '0')) view.setAttribute(name, value);
}
const token = takeToken() ?? query.get('token');
if (token !== null) view.setAttribute('token', token);
defineBrumeView();
view.setAttribute('src', location.href);

declare global {
  interface Window {
    readonly brume: Report;
  }
}
Object.defineProperty(window, 'brume', { get: () => view.report });
