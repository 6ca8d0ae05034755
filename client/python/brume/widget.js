// The browser's half of widget.py, as anywidget has it: <brume-view>, which the server itself brings, and a model whose
// values go both ways.
const ATTRIBUTES = ['token', 'controls', 'draw', 'size'];
const EVERY_MS = 200; // the camera is told at most so often
const ALIKE = 1e-4; // m, rad, and parts of a setting's value that 32 bits do not keep

const near = (a, b) => Math.abs(a - b) <= ALIKE * Math.max(1, Math.abs(a), Math.abs(b));
const alike = (a, b) =>
  Array.isArray(a) && Array.isArray(b)
    ? a.length === b.length && a.every((one, i) => near(one, b[i]))
    : typeof a === 'string' || typeof b === 'string'
      ? a === b
      : a != null && b != null && near(Number(a), Number(b));
const valueOf = (value) => (typeof value === 'boolean' ? Number(value) : value);

// The point that a camera turns about.
const pivotOf = ({ position: [x, y, z], yaw, pitch, distance }) => [
  x - distance * Math.cos(pitch) * Math.sin(yaw),
  y + distance * Math.sin(pitch),
  z - distance * Math.cos(pitch) * Math.cos(yaw),
];

function render({ model, el }) {
  const ending = new AbortController();
  const view = document.createElement('brume-view');
  const line = document.createElement('p');
  const page = () => new URL(model.get('src'), location.href);
  const tell = (values) => {
    for (const [name, value] of Object.entries(values)) model.set(name, value);
    model.save_changes();
  };
  const listen = (name, act) => {
    const on = () => act();
    model.on(`change:${name}`, on);
    ending.signal.addEventListener('abort', () => model.off?.(`change:${name}`, on));
  };
  const hear = (name, act) => view.addEventListener(name, act, { signal: ending.signal });
  const write = (name) => {
    const value = model.get(name);
    if (value === null || value === undefined || value === '') view.removeAttribute(name);
    else view.setAttribute(name, Array.isArray(value) ? value.join() : String(value));
  };

  // ---- the camera ----
  let due;
  const tellCamera = () => {
    due = undefined;
    const camera = view.report?.camera;
    if (!camera || ending.signal.aborted) return;
    const now = { position: [...camera.position], target: pivotOf(camera) };
    if (Object.entries(now).some(([name, value]) => !alike(model.get(name), value))) tell(now);
  };
  const drawn = () => (due ??= setTimeout(tellCamera, EVERY_MS));
  const move = () => {
    const camera = view.report?.camera;
    const [position, target, fov] = ['position', 'target', 'fov'].map((name) => model.get(name) ?? undefined);
    const there =
      camera && (!position || alike(position, camera.position)) && (!target || alike(target, pivotOf(camera)));
    if (there && String(fov ?? '') === (view.getAttribute('fov') ?? '')) return; // what tellCamera() told
    for (const name of ['position', 'target', 'fov']) write(name);
    // Also where the attributes are as before, and the camera has been moved since.
    view.viewer?.moveTo({ position, target, fov });
  };

  // ---- settings ----
  let reported, wanted;
  const change = () => {
    if (!reported) return void (wanted = true); // until there is a connection
    const changes = Object.entries(model.get('settings') ?? {})
      .filter(([path, value]) => !alike(reported[path], value))
      .map(([path, value]) => ({ path, value: valueOf(value) }));
    if (changes.length > 0) view.viewer?.command({ kind: 'set', changes });
  };
  const adopt = () => {
    const scene = view.report?.scene;
    if (!scene) return;
    reported = scene.settings;
    if (wanted) {
      wanted = false;
      change();
      return; // the next report has them
    }
    tell({ settings: { ...reported }, tick: scene.tick });
  };

  hear('picture', drawn);
  hear('drawn', drawn);
  hear('scenechange', adopt);
  hear('statechange', ({ detail }) => {
    if (detail.name !== 'connected') reported = undefined;
    tell({ state: detail.name });
  });
  hear('note', ({ detail }) => tell({ note: detail.text })); // what was refused is taken back with the next report
  for (const name of ATTRIBUTES) listen(name, () => write(name));
  for (const name of ['position', 'target', 'fov']) listen(name, move);
  listen('settings', change);
  const shape = () => Object.assign(view.style, { width: model.get('width'), height: model.get('height') });
  for (const name of ['width', 'height']) listen(name, shape);

  const connect = async () => {
    const from = new URL('brume-view.js', page());
    try {
      await import(from.href);
    } catch {
      line.textContent =
        `${from.href} cannot be loaded: is the server there, and was it started with ` +
        `--allow-origin ${location.origin}?`;
      el.replaceChildren(line);
      return tell({ state: 'refused', note: line.textContent });
    }
    if (ending.signal.aborted) return;
    for (const name of [...ATTRIBUTES, 'position', 'target', 'fov']) write(name);
    view.setAttribute('src', page().href);
    el.replaceChildren(view);
  };
  listen('src', () => void connect());
  shape();
  void connect();
  return () => {
    ending.abort();
    clearTimeout(due);
    view.remove();
  };
}

export default { render };
