// One viewer of a server, without a page around it: connection, pictures, camera, pushes, headset.
import { AutoLayers } from './auto-layers';
import { AutoSize } from './auto-size';
import { fitAspect, lookAt } from './camera';
import type { Camera } from './camera';
import { Connection } from './connection';
import type { LinkState } from './connection';
import { Controls } from './controls';
import type { Mode } from './controls';
import type { DrawWish } from './draw-choice';
import { Drawing } from './drawing';
import { Headset } from './headset';
import type { HeadsetMode } from './headset';
import type { Latency } from './latency';
import { OverPicture } from './over-picture';
import { People } from './people';
import { Picture } from './picture';
import { Poses } from './poses';
import type { Command, Frame, SceneState, ServerMessage, Welcome } from './protocol';
import { Pusher } from './pusher';
import { report } from './report';
import type { Report } from './report';
import { mayControl, mayPush } from './role';
import { PAUSED, valuesOf } from './shared-settings';
import type { Values } from './shared-settings';
import { defaultCap } from './size';
import type { Size } from './size';
import { Statistics } from './statistics';
import { firstCamera, placed } from './place';
import type { Place } from './place';
import { controlsHost, drawingHost, peopleHost } from './viewer-parts';
import { Viewing } from './viewing';
import type { Eyes, ReprojectionWish } from './viewing';
import type { Stage, ViewerEvents, Wishes } from './viewer-host';
import { Visibility, watchSight } from './visibility';

const RESIZE_SETTLE_MS = 150;
const ERROR_FULL = 5; // ErrorCode.full; the connection's state shows it, no note does
const CLIENT = 'brume-web 0.1.0';

const sameCamera = (a: Welcome, b: Welcome): boolean => JSON.stringify(a.camera) === JSON.stringify(b.camera);

export class Viewer {
  readonly statistics = new Statistics();
  readonly viewing: Viewing;
  readonly report: Report;
  readonly link: Connection;
  readonly drawing: Drawing;
  readonly people: People;
  welcome: Welcome | undefined;
  scene: SceneState | undefined;
  values: Values = new Map(); // of the scene's settings, as last reported
  camera: Camera = lookAt([0, 2, 26], [0, 0, 0]);
  mode: Mode = 'orbit';
  headset: Headset | undefined;
  // The camera that the first welcome starts with, instead of the place; for viewers that were here before.
  arrived: { camera: Camera; scene?: string | undefined } | undefined;
  size: Size; // of one eye's picture, as asked for
  linkState: LinkState['name'] = 'connecting';
  limit = Infinity; // pixels of one eye that the server draws at most, as far as its welcome tells
  home = this.camera; // the scene's own, or the place
  private push = false;
  private inSight = true; // the view on the page
  private readonly autoSize = new AutoSize();
  private readonly autoLayers = new AutoLayers({
    pace: (now) => ({ rate: this.expectedRate(now), latencyMs: this.latencyMs }),
    use: (layers) => this.reshape(() => this.viewing.takeLayers(layers)),
  });
  private readonly poses = new Poses(this);
  private readonly over: OverPicture;
  private readonly picture: Picture;
  private readonly controls: Controls;
  private readonly visibility: Visibility;
  private readonly ending = new AbortController();
  private readonly resized: ResizeObserver;
  private before = performance.now();
  private helloSize: Size = { width: 0, height: 0 };

  constructor(
    private readonly stage: Stage,
    readonly wishes: Wishes,
    address: string,
    private readonly events: ViewerEvents,
  ) {
    const { canvas, warped, surface } = stage;
    this.viewing = new Viewing(canvas, warped, this, this.ending.signal);
    this.size = this.viewing.size();
    this.picture = new Picture(this.viewing, {
      presented: (frame, at) => {
        this.link.acknowledge(frame.id);
        events.picture(frame, this.statistics.presented(frame, at));
      },
      dropped: (frame) => this.link.acknowledge(frame.id),
      failed: (frame) => {
        this.link.acknowledge(frame.id);
        events.note('A picture could not be read.', 'error');
      },
    });
    this.link = new Connection(
      address,
      {
        hello: () => {
          this.helloSize = this.size;
          const views = this.headset?.views ?? this.viewing.views;
          return { client: CLIENT, ...this.size, views, quality: this.wishes.quality, drawHz: this.drawing.hello() };
        },
        state: (state) => {
          const again = this.linkState === 'connected';
          this.linkState = state.name;
          this.headset?.linked(state.name === 'connected');
          if (state.name === 'connected') this.enter(state.welcome, again);
          events.link(state);
        },
        message: (message, bytes) => this.receive(message, bytes),
        roundTrip: (ms) => this.statistics.roundTrip(ms),
        moved: (page) => events.moved(page),
        renew: () => events.renew(),
      },
      this.ending.signal,
    );
    this.drawing = new Drawing(drawingHost(this, events));
    this.people = new People(peopleHost(this, events));
    this.over = new OverPicture(stage.canvas, stage.drawing);
    // Pushes that are made without a connection are lost.
    const pusher = new Pusher((impulse) => void this.link.sendInput(impulse));
    this.controls = new Controls(
      surface,
      stage.keys,
      controlsHost(this, this.poses, events),
      pusher,
      this.ending.signal,
    );
    // The server draws nothing for a page that is hidden, or a view that is scrolled away. Animation frames, which send
    // the other poses, stop in a hidden page, too.
    this.visibility = new Visibility(() => this.link.connected && this.poses.ask(performance.now()));
    watchSight(surface, this.ending.signal, (seen) => {
      this.inSight = seen;
      this.look();
    });
    let settle: number | undefined;
    this.resized = new ResizeObserver(() => {
      window.clearTimeout(settle);
      settle = window.setTimeout(() => this.resize(), RESIZE_SETTLE_MS);
    });
    this.report = report(this);
  }

  start(): void {
    this.resized.observe(this.stage.surface);
    requestAnimationFrame(this.animate);
    this.link.start();
  }

  // Says goodbye and leaves nothing behind that runs.
  stop(): void {
    this.headset?.end();
    this.ending.abort();
    this.resized.disconnect();
    this.link.stop();
    this.picture.clear();
  }

  get fovY(): number {
    return this.wishes.place.fov ?? this.welcome?.camera.fovY ?? 0.8;
  }

  get cap(): Size {
    return this.wishes.cap ?? this.autoSize.cap;
  }

  get mayPush(): boolean {
    return ['push', 'touch'].includes(this.wishes.control) && mayPush(this.welcome?.role ?? 'operator');
  }

  get mayControl(): boolean {
    return mayControl(this.welcome?.role ?? 'operator');
  }

  get latencyMs(): number {
    return this.statistics.average.get()?.total ?? 0;
  }

  get pushing(): boolean {
    return this.push;
  }

  set pushing(on: boolean) {
    this.push = on && this.mayPush;
    this.events.changed();
  }

  // Number of the pose that was sent for the camera as it is; undefined while a newer one is due.
  get sentPose(): number | undefined {
    return this.poses.current;
  }

  get hidden(): boolean {
    return this.visibility.hidden;
  }

  // Pictures a second; undefined unless the medium moves and somebody looks.
  private expectedRate(now: number): number | undefined {
    const moves = this.scene !== undefined && !this.scene.standstill && this.values.get(PAUSED) !== 1;
    const looked = this.link.connected && this.inSight && !this.headset && !this.drawing.shown;
    return moves && looked ? this.statistics.shownRate.perSecond(now) : undefined;
  }

  setMode(mode: Mode): void {
    this.mode = mode;
    this.events.changed();
  }

  command(order: Command): void {
    if (!this.link.sendInput(order)) this.events.note('Not connected: that change was not sent.', 'error');
  }

  // The first camera, for the shape that the window has now.
  goHome(): void {
    if (!this.people.takesBack()) return;
    this.camera = fitAspect(this.home, this.aspect());
  }

  // Looks from another place, which goHome() then means.
  moveTo(place: Place): void {
    this.wishes.place = place;
    if (!this.welcome) return;
    this.home = placed(place, this.welcome.camera);
    if (this.people.takesBack()) this.camera = this.home;
  }

  resize(): void {
    const next = this.viewing.size();
    if (next.width !== this.size.width || next.height !== this.size.height) this.size = next;
  }

  again(): void {
    this.drawing.lose();
    this.resize();
    this.picture.again();
  }

  // Chooses who draws, which is part of the hello.
  chooseDraw(wish: DrawWish): void {
    this.drawing.choice.choose(wish);
  }

  setQuality(quality: number): void {
    this.wishes.quality = quality;
    if (this.link.connected) this.link.reopen(); // the quality is part of the hello
  }

  // Chooses eyes and reprojection. The number of eyes is part of the hello, so a change of it connects again. Returns
  // false if this browser cannot do it.
  choose(eyes: Eyes, wished: ReprojectionWish): boolean {
    if (wished !== this.viewing.wished) this.autoLayers.begin();
    if (this.reshape(() => this.viewing.choose(eyes, wished))) return true;
    this.events.note('This browser has no WebGL 2, which that needs.', 'error');
    return false;
  }

  // `change` may change how many pictures are asked for, and how large. Returns what it returns.
  private reshape(change: () => boolean): boolean {
    const { views } = this.viewing;
    if (!change()) return false;
    this.resize();
    if (this.viewing.views !== views && this.link.connected && !this.headset) this.link.reopen();
    return true;
  }

  async toggleHeadset(mode: HeadsetMode = 'vr'): Promise<void> {
    if (this.headset) return this.headset.end();
    try {
      this.headset = await Headset.start(this, mode, this.viewing.wantsLayers, {
        ask: (wish) => this.poses.askFor(wish, performance.now()),
        push: (command) => void this.link.sendInput(command),
        asksForBoth: () => this.link.connected && this.link.reopen(),
        beforeFrame: () => this.picture.draw(),
        worn: () => this.look(),
        ended: (why) => this.useHeadset(undefined, why),
      });
    } catch (error) {
      this.events.note(error instanceof Error ? error.message : String(error), 'error');
      return;
    }
    this.useHeadset(this.headset);
  }

  private useHeadset(headset: Headset | undefined, why?: string): void {
    this.headset = headset;
    this.picture.drawOn(headset ?? this.viewing);
    if (why) this.events.note(why, 'info');
    if (this.link.connected) this.link.reopen();
    this.look();
    this.events.changed();
  }

  // To be called when somebody has begun or ceased to see the pictures, on the page or in a headset.
  private look(): void {
    this.statistics.answeredPose = this.link.lastPose; // frames of earlier poses were not presented when they came
    this.visibility.update(this.headset?.hidden ?? !this.inSight);
    this.link.hurry();
  }

  private aspect(): number {
    return this.stage.canvas.clientWidth / Math.max(1, this.stage.canvas.clientHeight);
  }

  // `again`: true for another welcome on the same connection, which tells of another scene.
  private enter(greeting: Welcome, again: boolean): void {
    const { arrived, wishes, welcome } = this;
    // The camera starts at the scene's own; in the same scene it stays where it was.
    if (welcome?.scene !== greeting.scene || (again && !sameCamera(welcome, greeting))) {
      if (welcome) wishes.place = {}; // it was meant for the scene before
      const first = firstCamera(wishes.place, greeting.camera, this.aspect());
      const known = arrived && (arrived.scene ?? greeting.scene) === greeting.scene;
      [this.home, this.camera] = [first.home, known ? arrived.camera : first.camera];
      this.arrived = undefined;
    }
    this.welcome = greeting;
    this.autoSize.begin(defaultCap(greeting.device));
    this.autoLayers.connect(greeting.scene);
    this.poses.reset();
    this.statistics.reset();
    this.picture.clear();
    this.viewing.clear();
    this.drawing.clear();
    const asked = this.helloSize.width * this.helloSize.height;
    const granted = greeting.width * greeting.height;
    this.limit = granted < 0.98 * asked ? granted : Infinity;
    if (!this.mayPush) this.push = false;
    this.resize();
    this.people.begin();
    this.events.welcome(greeting);
    this.events.changed();
    if (this.visibility.hidden) this.poses.ask(performance.now());
  }

  private receive(message: ServerMessage, bytes: number): void {
    this.statistics.byteRate.add(performance.now(), bytes);
    switch (message.kind) {
      case 'frame':
        if (message.follows !== 0) this.people.takeCamera(message.position, message.orientation);
        this.drawing.pictureCame();
        this.picture.show(message);
        this.followSpeed(message);
        if (this.viewing.asksForLayers) this.autoLayers.came(message.layers, performance.now());
        break;
      case 'lit':
        this.drawing.receive(message);
        break;
      case 'scene':
        this.autoLayers.follow(message.plan?.method);
        this.scene = message;
        this.values = valuesOf(this.welcome?.settings ?? [], message.settings);
        this.events.scene(message);
        break;
      case 'people':
        this.people.receive(message);
        break;
      case 'error':
        if (message.code !== ERROR_FULL) this.events.note(message.text || 'The server refused that.', 'error');
        break;
    }
  }

  // Larger pictures than the one asked for are late ones of before, and say nothing of it.
  private followSpeed(frame: Frame): void {
    if (this.wishes.cap || this.headset || frame.follows !== 0 || frame.width > this.size.width) return;
    const answer = {
      serverMs: frame.stages.render + frame.stages.encode,
      relaxed: this.scene?.plan?.relaxed ?? 0,
      quality: frame.quality,
      smaller: frame.width < this.size.width,
      limit: this.limit,
    };
    const most = this.viewing.size({ width: Infinity, height: Infinity });
    const more = most.width > this.size.width || most.height > this.size.height;
    if (this.autoSize.saw(answer, more, performance.now())) this.resize();
  }

  // Once per animation frame.
  private readonly animate = (now: number): void => {
    if (this.ending.signal.aborted) return;
    requestAnimationFrame(this.animate);
    if (this.headset) return; // the headset's own animation frames do all of this
    this.picture.draw();
    this.controls.update(now, Math.min(0.1, Math.max(0, (now - this.before) / 1000)));
    this.before = now;
    this.autoLayers.look(now);
    this.drawing.follow();
    const moment = this.drawing.at(performance.now());
    if (moment) this.viewing.drawMoment(moment, this.drawing, now);
    else this.viewing.draw();
    this.over.draw(this);
    this.poses.follow(now);
  };
}
