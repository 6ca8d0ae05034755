// People: messages, whose camera a viewer has, and what is drawn of others.
import { describe, expect, test } from 'vitest';
import { lookAt, orientation } from '../src/camera';
import type { Camera } from '../src/camera';
import { decode } from '../src/decode';
import { People, cameraAt, coneOf } from '../src/people';
import type { PeopleHost } from '../src/people';
import { coneSeen, seenAt } from '../src/people-drawing';
import { leaderText } from '../src/people-panel';
import { encodeLead, encodePresence } from '../src/people-wire';
import type { PeopleMessage, Person, Presence, Vec3, Welcome } from '../src/protocol';
import type { Role } from '../src/role';
import { bytesOf, examples, readMessage } from './examples';

describe('messages', () => {
  test('presence and lead are written as the examples are', () => {
    const said: Presence = {
      name: 'Zoë',
      pointer: { origin: [1.5, -2.25, 26], direction: [0.5, 0.75, 0.25] },
      follow: 3,
      cameras: true,
    };
    for (const [name, bytes] of [
      ['presence', encodePresence(said)],
      ['lead', encodeLead(3)],
    ] as const) {
      const example = examples[name] ?? { type: '', body: {} };
      expect(readMessage(bytes.slice(), example)).toEqual({ type: example.type, body: example.body });
    }
    const alone = encodePresence({ name: '', follow: 0, cameras: false });
    const like = examples['presence_of_nobody'] ?? { type: '', body: {} };
    expect(readMessage(alone.slice(), { ...like, body: { follow: 0, cameras: false } })).toMatchObject({
      body: { follow: 0, cameras: false },
    });
  });

  test('people are read as they were written', () => {
    const people = decode(bytesOf('people'));
    expect(people).toEqual({
      kind: 'people',
      count: 70,
      presenter: 3,
      people: [
        {
          ...{ id: 3, name: 'ann', known: true, colour: '#e69f00', role: 'presenter', follows: 0 },
          look: { position: [1.5, -2.25, 26], orientation: [0, 0.6, 0, 0.8].map(Math.fround), right: 0.75, up: 0.5 },
          pointer: [0.5, 0.75, 0.25],
        },
        { id: 4, name: '<b>bob</b>', known: false, colour: '#56b4e9', role: 'viewer', follows: 3 },
      ],
    });
  });
});

const person = (id: number, more: Partial<Person> = {}): Person => ({
  ...{ id, name: `p${id}`, known: false, colour: '#ffffff', role: 'viewer', follows: 0 },
  ...more,
});
const told = (presenter: number, ...people: Person[]): PeopleMessage => ({
  ...{ kind: 'people', people, count: people.length, presenter },
});

// A viewer of id 1 without a page.
function viewer(role: Role = 'operator', drawsHere = false) {
  const sent: string[] = [];
  const host: PeopleHost & { changes: number; camera: Camera } = {
    changes: 0,
    camera: lookAt([0, 0, 10], [0, 0, 0]),
    welcome: { viewer: 1, people: true, role } as Welcome,
    drawsHere,
    send: (bytes) => sent.push(bytes.length > 60 ? 'presence' : bytes.length > 0 ? 'message' : ''),
    told: () => ++host.changes,
  };
  const people = new People(host);
  people.begin();
  return { people, host, sent };
}

describe('whose camera a viewer has', () => {
  test('is its own until it follows, and again when it moves', () => {
    const { people, host } = viewer();
    people.receive(told(0, person(1), person(2)));
    expect(people.leader).toBeUndefined();
    people.follow(2);
    expect(people.leader?.id).toBe(2);
    people.takeCamera([5, 1, 5], orientation(lookAt([5, 1, 5], [0, 0, 0])));
    expect(host.camera.position).toEqual([5, 1, 5]);
    expect(leaderText(people)).toBe('Following p2 until you move.');
    expect(people.takesBack()).toBe(true);
    expect(people.leader).toBeUndefined();
    people.takeCamera([9, 9, 9], [0, 0, 0, 1]); // a picture that was on its way
    expect(host.camera.position).toEqual([5, 1, 5]);
  });

  test('is the presenter’s, which no move takes back', () => {
    const { people } = viewer('viewer');
    people.receive(told(2, person(1), person(2)));
    expect(people.held).toBe(true);
    expect(people.takesBack()).toBe(false);
    expect(leaderText(people)).toBe('p2 presents: you see what they see.');
    people.receive(told(0, person(1), person(2)));
    expect(people.takesBack()).toBe(true);
    expect(leaderText(people)).toBe('');
  });

  test('is one’s own while one presents', () => {
    const { people } = viewer();
    people.receive(told(1, person(1), person(2)));
    expect(people.leader).toBeUndefined();
    expect(people.takesBack()).toBe(true);
  });

  test('is one’s own when the other has left', () => {
    const { people } = viewer();
    people.receive(told(0, person(1), person(2)));
    people.follow(2);
    people.receive(told(0, person(1)));
    expect(people.leader).toBeUndefined();
    expect(people.following).toBe(0);
  });

  test('comes with the people where the page draws by itself', () => {
    const { people, host } = viewer('operator', true);
    const turn = orientation(lookAt([3, 4, 5], [0, 0, 0]));
    const other = person(2, { look: { position: [3, 4, 5], orientation: turn, right: 1, up: 1 } });
    people.receive(told(0, person(1), other));
    expect(host.camera.position).toEqual([0, 0, 10]);
    people.follow(2);
    people.receive(told(0, person(1), other));
    expect(host.camera.position).toEqual([3, 4, 5]);
  });

  test('may be led by presenters and operators', () => {
    for (const [role, may] of [
      ['viewer', false],
      ['pusher', false],
      ['controller', false],
      ['presenter', true],
      ['operator', true],
    ] as const)
      expect(viewer(role).people.mayLead).toBe(may);
  });
});

describe('what is drawn of others', () => {
  const eye = { position: [0, 0, 10] as Vec3, orientation: [0, 0, 0, 1] as const, fovY: Math.PI / 2 };
  const area = { x: 10, y: 20, width: 200, height: 100 };

  test('a camera keeps its place and view', () => {
    for (const [from, to] of [
      [
        [1, 2, 3],
        [0, 0, 0],
      ],
      [
        [0, 5, 0],
        [4, 5, 0],
      ],
      [
        [3, -2, 8],
        [3, 1, 20],
      ],
    ] as const) {
      const camera = lookAt(from, to);
      const again = cameraAt(camera.position, orientation(camera), camera.distance);
      expect(again.yaw).toBeCloseTo(camera.yaw, 9);
      expect(again.pitch).toBeCloseTo(camera.pitch, 9);
    }
    // Straight down: the yaw is that of the picture's upper side.
    const down = cameraAt([0, 9, 0], [-Math.SQRT1_2, 0, 0, Math.SQRT1_2], 9);
    expect(down.pitch).toBeCloseTo(-Math.PI / 2 + 0.01, 9);
    expect(down.yaw).toBeCloseTo(0, 9);
  });

  test('places are where they are seen', () => {
    for (const [place, x, y] of [
      [[0, 0, 0], 110, 70],
      [[10, 0, 0], 160, 70],
      [[0, 10, 0], 110, 20],
    ] as const) {
      const seen = seenAt(place, eye, area);
      expect(seen?.x).toBeCloseTo(x, 9);
      expect(seen?.y).toBeCloseTo(y, 9);
    }
    expect(seenAt([0, 0, 11], eye, area)).toBeUndefined();
  });

  test('a cone has the shape of its picture', () => {
    const look = { position: [0, 0, 0] as Vec3, orientation: [0, 0, 0, 1] as const, right: 2, up: 1 };
    expect(coneOf(look, 3)).toEqual([
      [0, 0, 0],
      [-6, -3, -3],
      [6, -3, -3],
      [6, 3, -3],
      [-6, 3, -3],
    ]);
    expect(coneSeen(look, eye, area)).toHaveLength(8);
    expect(coneSeen({ ...look, position: [0, 0, 50] }, eye, area)).toHaveLength(0);
  });
});
