// Bins of objects: which boxes and spheres the rays of a bin of pixels may hit, as object_bins.comp writes it. A bin
// has a bit for each of them in `objectWords()` words. Before those stand words with a bit for each word that is not 0.
// Include after the tick and the eye's blocks, and `uint object_bins[]`.
uint objectWords() { return (tick.opaque_count - tick.plane_count + 31) / 32; }
uint wordsOfWords() { return (objectWords() + 31) / 32; }
uvec2 objectBins() { return (eye.size + kObjectBin - 1) / kObjectBin; }
// Index of the first word of a bin.
uint objectBin(uint bin) { return bin * (wordsOfWords() + objectWords()); }
uint objectBinOf(uvec2 pixel) { return objectBin(pixel.y / kObjectBin * objectBins().x + pixel.x / kObjectBin); }

// The objects of a bin, one after the other.
struct BinWalk {
    uint bin;          // index of its first word
    uint words, bits;  // those that are left
    uint group, word;  // indices of the words that they were read from
    uint visited;      // number of objects so far
};

BinWalk walkBin(uint bin) { return BinWalk(bin, object_bins[bin], 0, 0, 0, 0); }

// True if there is one more, `object`.
bool nextObject(inout BinWalk walk, out uint object) {
    object = 0;
    [[dont_unroll]] while (walk.bits == 0) {
        [[dont_unroll]] while (walk.words == 0) {
            if (++walk.group >= wordsOfWords()) return false;
            walk.words = object_bins[walk.bin + walk.group];
        }
        walk.word = 32 * walk.group + findLSB(walk.words);
        walk.words &= walk.words - 1;
        walk.bits = object_bins[walk.bin + wordsOfWords() + walk.word];
    }
    object = tick.plane_count + 32 * walk.word + findLSB(walk.bits);
    walk.bits &= walk.bits - 1;
    ++walk.visited;
    return true;
}
