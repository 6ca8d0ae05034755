// The panel's group of people: who is here, one's own name, following and presenting.
import { el, setPressed, setText } from './dom';
import { button, group, toggle } from './fields';
import type { People } from './people';
import type { Person } from './protocol';

const MOST_NAME = 32; // characters
const KEY = 'brume-name'; // in the browser's storage

export function keptName(): string {
  try {
    return (localStorage.getItem(KEY) ?? '').slice(0, MOST_NAME);
  } catch {
    return ''; // no storage
  }
}

function keepName(name: string): void {
  try {
    localStorage.setItem(KEY, name);
  } catch {
    // Private windows may refuse to store.
  }
}

// One line on whose camera this viewer has; empty: its own.
export function leaderText(people: People): string {
  const { leader, held } = people;
  if (!leader) return '';
  return held ? `${leader.name} presents: you see what they see.` : `Following ${leader.name} until you move.`;
}

interface Row {
  element: HTMLLIElement;
  follow(person: Person, people: People): void;
}

function rowOf(id: number, people: () => People): Row {
  const dot = el('i', { class: 'dot', 'aria-hidden': 'true' });
  const name = el('span', { class: 'name' });
  const says = el('small');
  const press = button('Follow', '', () => people().follow(people().following === id ? 0 : id));
  const element = el('li', {}, dot, name, says, press);
  return {
    element,
    follow: (person, now) => {
      const me = person.id === now.me?.id;
      dot.style.background = person.colour;
      setText(name, person.name);
      element.classList.toggle('me', me);
      const leader = now.byId(person.follows);
      const parts = [
        me ? 'you' : '',
        person.known ? 'named by a token' : '',
        person.id === now.now.presenter ? 'presents' : '',
        leader && person.id !== now.now.presenter ? `follows ${leader.name}` : '',
        person.pointer ? 'points' : '',
      ];
      setText(says, parts.filter((part) => part !== '').join(', '));
      press.hidden = me;
      press.disabled = now.now.presenter !== 0;
      press.title = `Take the camera of ${person.name} until you move`;
      press.setAttribute('aria-label', `Follow ${person.name}`);
      setPressed(press, now.following === person.id);
    },
  };
}

export interface PeoplePanel {
  element: HTMLElement;
  update(): void; // people have changed
}

export function peoplePanel(people: () => People): PeoplePanel {
  const input = el('input', {
    type: 'text',
    maxlength: String(MOST_NAME),
    autocomplete: 'nickname',
    spellcheck: 'false',
  });
  input.value = keptName();
  input.placeholder = 'Guest';
  const send = (): void => {
    keepName(input.value);
    people().rename(input.value);
  };
  input.addEventListener('input', send);
  const name = el('label', { class: 'field', title: 'How others see you' }, el('span', {}, 'Your name'), input);
  const list = el('ul', { class: 'people', 'aria-label': 'People here' });
  const more = el('small');
  const present = button('Present', 'All see what you see, until you stop', () =>
    people().lead(people().now.presenter === 0),
  );
  const cameras = toggle(
    'Others’ cameras',
    (on) => people().showCameras(on),
    'Small cones in the picture, in the colours of people',
  );
  cameras.follow(false);
  const rows = new Map<number, Row>();
  const element = group('People', false, name, list, more, cameras.element, el('div', { class: 'actions' }, present));

  return {
    element,
    update: () => {
      const now = people();
      element.hidden = !now.there;
      const { presenter, me } = now;
      input.disabled = me?.known ?? false;
      if (me?.known) input.value = me.name;
      for (const [id, row] of rows) {
        if (now.byId(id)) continue;
        row.element.remove();
        rows.delete(id);
      }
      for (const person of now.now.people) {
        let row = rows.get(person.id);
        if (!row) {
          row = rowOf(person.id, people);
          rows.set(person.id, row);
          list.append(row.element);
        }
        row.follow(person, now);
      }
      const rest = now.now.count - now.now.people.length;
      setText(more, rest > 0 ? `and ${rest} more` : '');
      present.hidden = !now.mayLead;
      setPressed(present, presenter !== undefined);
      setText(
        present,
        !presenter ? 'Present' : presenter.id === me?.id ? 'Stop presenting' : `Release ${presenter.name}`,
      );
    },
  };
}
