// Bits of lines, bins[line][32 particles], have pages: one bit per 2,048 particles and line, set where any of their bits is, behind them
// in the same buffer. Where particles that are neighbours in space are neighbours in memory most pages of a tile are empty.

const uint kPage = 64; // words of a page, each of 32 particles

uint pageWords(uint words) { return (words + 32 * kPage - 1) / (32 * kPage); }

// Of pages 32 part ... 32 part + 31 of a line; `lines`: how many there are, `words`: of each.
uint pageWord(uint line, uint part, uint lines, uint words) { return lines * words + line * pageWords(words) + part; }
