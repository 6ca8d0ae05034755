// Messages about people: Presence and Lead to the server, People from it.
import { Builder } from 'flatbuffers';
import { finish, vec3 } from './encode';
import { ProtocolError } from './protocol';
import type { PeopleMessage, Person, Presence, Vec3 } from './protocol';
import { roleOf } from './role';
import { Body } from './wire/brume/wire/body';
import { Lead as WireLead } from './wire/brume/wire/lead';
import type { People as WirePeople } from './wire/brume/wire/people';
import type { Person as WirePerson } from './wire/brume/wire/person';
import { Presence as WirePresence } from './wire/brume/wire/presence';
import { Ray as WireRay } from './wire/brume/wire/ray';

const MOST_PEOPLE = 64;
const MOST_NAME = 64; // UTF-16 units of a name; the rest is cut off

export function encodePresence({ name, pointer, follow, cameras }: Presence): Uint8Array<ArrayBuffer> {
  const builder = new Builder(128);
  const text = builder.createString(name);
  WirePresence.startPresence(builder);
  WirePresence.addName(builder, text);
  if (pointer) {
    const { origin, direction } = pointer;
    WirePresence.addPointer(builder, WireRay.createRay(builder, ...origin, ...direction));
  }
  WirePresence.addFollow(builder, follow);
  WirePresence.addCameras(builder, cameras);
  return finish(builder, Body.Presence, WirePresence.endPresence(builder));
}

export function encodeLead(person: number): Uint8Array<ArrayBuffer> {
  const builder = new Builder(64);
  return finish(builder, Body.Lead, WireLead.createLead(builder, person));
}

const finite = (v: Vec3): boolean => v.every(Number.isFinite);

function decodePerson(wire: WirePerson | null): Person {
  if (!wire) throw new ProtocolError('a person that is not there');
  const [look, pointer] = [wire.look(), wire.pointer()];
  const [position, turn, at] = [look?.position(), look?.orientation(), pointer];
  const place: Vec3 | undefined = at ? [at.x(), at.y(), at.z()] : undefined;
  return {
    id: wire.id(),
    name: (wire.name() ?? '').slice(0, MOST_NAME),
    known: wire.known(),
    colour: `#${(wire.colour() & 0xffffff).toString(16).padStart(6, '0')}`,
    role: roleOf(wire.role()),
    follows: wire.follows(),
    ...(look && position && turn
      ? {
          look: {
            position: [position.x(), position.y(), position.z()],
            orientation: [turn.x(), turn.y(), turn.z(), turn.w()],
            right: look.right(),
            up: look.up(),
          },
        }
      : {}),
    ...(place && finite(place) ? { pointer: place } : {}),
  };
}

export function decodePeople(wire: WirePeople): PeopleMessage {
  const count = wire.peopleLength();
  if (count > MOST_PEOPLE) throw new ProtocolError('too many people');
  return {
    kind: 'people',
    people: Array.from({ length: count }, (_, i) => decodePerson(wire.people(i))),
    count: wire.count(),
    presenter: wire.presenter(),
  };
}
