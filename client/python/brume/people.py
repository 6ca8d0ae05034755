"""Who else looks at the scene, and what a viewer says of itself to them."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, List, Optional, Sequence, Tuple

from brume import messages
from brume.error import BrumeError
from brume.kinds import Table, Vec3

ROLES = {1: 'viewer', 2: 'controller', 3: 'operator', 4: 'pusher', 5: 'presenter'}
MOST_NAME = 32  # characters


@dataclass(frozen=True)
class Person:
    id: int
    name: str
    known: bool  # True: its token says the name
    colour: str  # #rrggbb
    role: str
    follows: int  # id of the person whose camera it has; 0: its own
    pointer: Optional[Vec3]  # m; None: it points at nothing


@dataclass(frozen=True)
class People:
    people: Tuple[Person, ...] = ()  # in the order in which they came, 64 at most
    count: int = 0  # of all
    presenter: int = 0  # id of the person whose camera all take; 0: nobody presents

    def named(self, name: str) -> Person:
        """The first of that name; raises BrumeError if there is none."""
        for person in self.people:
            if person.name == name:
                return person
        raise BrumeError(f'nobody is here named {name!r}', 'unknown_name')


def people_of(table: Table) -> People:
    """Of the newest People message; None: none came yet."""
    if not table:
        return People()
    people: List[Person] = []
    for one in map(table.People, range(table.PeopleLength())):
        pointer = one.Pointer()
        people.append(Person(id=one.Id(), name=messages.text_of(one.Name()), known=bool(one.Known()),
                             colour=f'#{one.Colour() & 0xffffff:06x}', role=ROLES.get(one.Role(), 'viewer'),
                             follows=one.Follows(), pointer=messages.vector_of(pointer) if pointer else None))
    return People(tuple(people), table.Count(), table.Presenter())


@dataclass(frozen=True)
class Presence:
    """What a viewer says of itself; the last one counts."""
    name: str = ''
    pointer: Optional[Tuple[Sequence[float], Sequence[float]]] = None  # origin, m, and direction of a ray
    follow: int = 0

    def checked(self) -> Presence:
        if len(self.name) > MOST_NAME:
            raise BrumeError(f'a name has at most {MOST_NAME} characters', 'out_of_range')
        if self.pointer is not None and (len(self.pointer) != 2 or any(len(one) != 3 for one in self.pointer)):
            raise BrumeError('pointer is an origin and a direction, each x, y, z', 'out_of_range')
        return self

    def message(self) -> bytes:
        return messages.presence(self.name, self.pointer, self.follow)


KEEP: Any = object()  # of an argument: stays as it was
