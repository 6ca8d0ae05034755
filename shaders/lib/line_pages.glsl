// Pages of the bits of lines, bins[line][32 particles]: one bit per 2,048 particles and line, set if any of their
// bits is. Pages are stored behind the bits in the same buffer. With particles sorted in space, most pages of a tile
// are empty.

const uint kPage = 64; // words of a page, each of 32 particles

uint pageWords(uint words) { return (words + 32 * kPage - 1) / (32 * kPage); }

// Words of all bits and pages of lines, of which there are lines.x, lines.y and lines.z; `words`: words of each.
uint lineWords(uvec3 lines, uint words) { return (lines.x + lines.y + lines.z) * (words + pageWords(words)); }

// Index of the word with pages 32 part ... 32 part + 31 of a line. `lines`: number of lines, `words`: words of each.
uint pageWord(uint line, uint part, uint lines, uint words) { return lines * words + line * pageWords(words) + part; }
