// Rooms: addresses, and what the server says of them.
import { describe, expect, test } from 'vitest';
import { roomOf, roomsOf, serverOf } from '../src/rooms';

describe('rooms', () => {
  test('are below the server’s page, wherever a proxy has put it', () => {
    for (const [page, server, room] of [
      ['http://host:8080/', 'http://host:8080/', ''],
      ['http://host:8080/?a=1#b', 'http://host:8080/', ''],
      ['http://host/r/lab/', 'http://host/', 'lab'],
      ['http://host/r/lab', 'http://host/', 'lab'],
      ['https://host/clouds/brume/r/lab/?x=1', 'https://host/clouds/brume/', 'lab'],
      ['https://host/clouds/r/', 'https://host/clouds/r/', ''],
      ['https://host/r/a%2fb/', 'https://host/r/a%2fb/', ''],
    ] as const) {
      expect(serverOf(page).href).toBe(server);
      expect(roomOf(page)).toBe(room);
    }
  });

  test('are what the server says, without what is none', () => {
    const server = new URL('https://host/clouds/');
    const answer = {
      rooms: [
        { name: '', scene: 'cloud', viewers: 3, href: 'https://evil.example/' },
        { name: 'lab', scene: '<b>x</b>', viewers: 0 },
        { name: '../x', scene: 'cloud', viewers: 0 },
        { name: 'no', scene: 7, viewers: 0 },
        null,
      ],
    };
    expect(roomsOf(answer, server)).toEqual([
      { name: '', page: 'https://host/clouds/', scene: 'cloud', viewers: 3 },
      { name: 'lab', page: 'https://host/clouds/r/lab/', scene: '<b>x</b>', viewers: 0 },
    ]);
    expect(roomsOf(null, server)).toEqual([]);
    expect(roomsOf({ rooms: 'x' }, server)).toEqual([]);
  });
});
