// The method `slabs` by hand for a CPU's vector units: what its kernels read and write. Plain numbers and arrays only,
// since the kernels' files are compiled for instructions that this CPU may lack: an inline function of theirs that
// others share (the linker keeps one of them) would crash there.
#pragma once

#include <cstddef>
#include <cstdint>

namespace brume::bench::native {

inline constexpr uint32_t kTile = 8, kRays = kTile * kTile; // rays of a tile's side, and of a tile
inline constexpr uint32_t kMostLanes = 16;

// A particle as one eye's slabs add it: as gpu::SlabMember, and the slabs that it reaches.
struct Member {
    float x, y, z;        // right, down and view depth from the eye, m
    float across, along;  // log2(e) / (2 s^2), s = standard deviation across and along the view
    float sigma;          // 1/m, extinction at the centre
    uint32_t first, last; // slabs; none where first > last
    uint32_t run;         // slabs after which the recurrence starts anew, so that it never leaves float
};

struct Frame {
    uint32_t rate, slabs;     // pixels between rays; of a ray
    float depth, thickness;   // m: view depth of the first slab's near face, and of a slab
    float corner_x, corner_y; // of node (0, 0), m right and down per m of view depth
    float spacing;            // of nodes, the same
    const Member* members;    // of all particles
    // The eye in the light's map (column, row, plane), and what a ray of node (0, 0) moves there per m.
    float eye[3], ray[3];
    float right[3], down[3]; // and what a node to the right and below changes of that
    const float* light;      // its map: optical depths [plane][row][column]
    uint32_t light_size[3];  // columns, rows, planes
    float* field[2];         // per node: optical depth; scattered light (rho p E = 1) over opacity
    float* spline[2];        // coefficients of the same, from the node up and left of the first pixel's on
    uint32_t nodes;          // of a row in memory
    const float*
        weights[4]; // of the nodes at -1, 0, 1, 2 for pixels side by side: max(rate, kMostLanes), from the first column
    float colour[3];   // rho p E
    float* picture[4]; // red, green, blue, transmittance
    uint32_t width;    // pixels, a multiple of kMostLanes
};

struct Kernel {
    const char* name;
    uint32_t lanes;
    // A tile's members added up, and then its rays from near to far; added: slabs * kRays floats, 1/m.
    void (*add)(const Frame& frame, uint32_t x, uint32_t y, const uint32_t* list, size_t count, float* added);
    void (*light)(const Frame& frame, uint32_t x, uint32_t y, const float* added);
    // A row of the picture from the field; scratch: 2 * nodes floats.
    void (*row)(const Frame& frame, uint32_t y, float* scratch);
};

extern const Kernel kAvx512, kAvx2; // of x86-64 alone
extern const Kernel kPortable;      // for tests: slow

} // namespace brume::bench::native
