"""Names of types that several files use."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Sequence, Tuple, Union

Vec3 = Tuple[float, float, float]
Quat = Tuple[float, float, float, float]  # x, y, z, w
Size = Tuple[int, int]  # pixels, width and height
Value = Union[float, str, Sequence[float]]  # of a setting: a number or boolean, a text, or three numbers
Values = Dict[str, Value]  # by path
Lists = Dict[str, List[Values]]  # of each list its elements, by key
Table = Any  # of brume/wire, which flatc makes without types

if TYPE_CHECKING:
    from numpy.typing import NDArray
    Array = NDArray[Any]
else:
    Array = Any  # NumPy need not be there
Numbers = Union[float, Sequence[Any], Array]  # what set_particles() takes for a column
Points = Union[Sequence[Sequence[float]], Array]  # n x 3
