// Bins of objects: which boxes and spheres the rays of a bin of pixels may hit, as object_bins.comp writes it. A bin
// has a bit for each of them in `objectWords()` words, in the order of `object_order`: by bodyBegin(), the nearest
// first. Before those stand words with a bit for each word that is not 0. Include after the eye,
// `uint object_bins[]` and `uint object_order[]`.
#include "shaders/blocks/tick.glsl"

uint objectWords() { return (tick.opaque_count - tick.plane_count + 31) / 32; }
uint wordsOfWords() { return (objectWords() + 31) / 32; }
uvec2 objectBins() { return (eye.size + kObjectBin - 1) / kObjectBin; }
// Index of the first word of a bin.
uint objectBin(uint bin) { return bin * (wordsOfWords() + objectWords()); }
uint objectBinOf(uvec2 pixel) { return objectBin(pixel.y / kObjectBin * objectBins().x + pixel.x / kObjectBin); }

// Radius of a ball around the object, m.
float bodyReach(Opaque o, uint kind) { return kind == kBox ? length(o.half_size) : o.half_size.x; }
// View depth before which nothing of the object lies. `off`: its centre from the eye.
float bodyBegin(Opaque o, uint kind, vec3 off) { return -dot(off, eye.back) - bodyReach(o, kind); }

// The objects of a bin, the nearest first.
struct BinWalk {
    uint bin;          // index of its first word
    uint words, bits;  // those that are left
    uint group, word;  // indices of the words that they were read from
};

BinWalk walkBin(uint bin) { return BinWalk(bin, object_bins[bin], 0, 0, 0); }

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
    object = object_order[32 * walk.word + findLSB(walk.bits)];
    walk.bits &= walk.bits - 1;
    return true;
}
