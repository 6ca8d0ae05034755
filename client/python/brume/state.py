"""The scene as the server last reported it."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Optional, Tuple

from brume import messages
from brume.kinds import Lists, Table, Values, Vec3


@dataclass(frozen=True)
class State:
    """The scene as the server last reported it: when something changes, and once a second."""
    tick: int  # 60 a second
    hash: str  # of the simulation's state
    viewers: int
    particles: int
    paused: bool
    error: Optional[float]  # relative RMSE of the pictures, predicted; 1: not; None: the server does not say
    promised: Optional[float]  # relative RMSE that the pictures may have; None: nothing is promised, or not said
    method: str  # what is rendered with now, in a few words
    settings: Values = field(repr=False)  # every live setting by its path
    lists: Lists = field(repr=False)  # of each list, 'light' and 'fog', its elements: each a dictionary by key
    box: Optional[Tuple[Vec3, Vec3]]  # two corners of a box that holds the medium, m; None from an older server
    standstill: Optional[str] = None  # why no tick comes at present, in one line; None: ticks come
    preparing: Optional[str] = None  # the name of another scene that is being made ready to be shown; None: none is
    undo: Optional[str] = None  # what undo() would do now, in a few words; None: nothing
    not_drawable: Optional[str] = None  # why viewers cannot draw this scene by themselves, one line; None: they can


def state_of(welcome: Table, state: Table, lists: Table) -> State:
    """lists: the newest SceneState that has the lists, or None."""
    paths = [messages.text_of(welcome.Settings(i).Path()) for i in range(welcome.SettingsLength())]
    values = [messages.value_of(state.Settings(i)) for i in range(state.SettingsLength())]
    elements = {messages.text_of(welcome.Lists(i).Name()): messages.elements_of(welcome.Lists(i), lists.Lists(i))
                for i in range(min(welcome.ListsLength(), lists.ListsLength() if lists else 0))}
    plan = state.Plan()
    lo, hi = state.Lo(), state.Hi()
    method = plan.Text() or plan.Method() if plan else state.Method()
    return State(tick=state.Tick(), hash=f'{state.StateHash():016x}', viewers=state.Viewers(),
                 particles=state.Particles(), paused=bool(state.Paused()), error=plan.Error() if plan else None,
                 promised=(plan.Promised() or None) if plan else None, method=messages.text_of(method),
                 settings=dict(zip(paths, values)), lists=elements,
                 box=(messages.vector_of(lo), messages.vector_of(hi)) if lo and hi else None,
                 standstill=messages.text_of(state.Standstill()) or None,
                 preparing=messages.text_of(state.Preparing()) or None,
                 undo=messages.text_of(state.Undo()) or None,
                 not_drawable=messages.text_of(state.NotDrawable()) or None)
