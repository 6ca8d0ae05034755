// The medium between the eye and any place of the picture, from a coarse grid of rays. Include after lib/view.glsl, `field`,
// kHasOpaque, kSources and kRate are declared. `field` holds sets of planes of nodes: a set of optical depths, then kSources sets of
// scattered light (rho p E = 1): one where all particles have one albedo; else what red, green and blue of it the albedos leave, and
// then the same of ambient light. A set is one plane without opaque objects: the whole ray. With them slabs + 1, one per face from
// near to far, then that of the ray up to the surface that it hits; and behind all sets a plane says at which face that is. What a
// whole ray scatters is divided by its opacity: both are then smooth where the medium is band-limited, however dense it is.
// Last, where rays are more than a pixel apart, the planes of whole rays once more, as coefficients of a cubic B-spline.

uint fieldNodes() { return grid.nodes.x * grid.nodes.y; }
uint fieldSet() { return (kHasOpaque ? grid.slabs + 2 : 1) * fieldNodes(); }
// Where the planes begin: of the faces, of whole rays, of the faces at which they end, of the spline's coefficients of the same, in this order.
uint fieldSetOf(uint c) { return field_at + c * fieldSet(); }
uint fieldWhole(uint c) { return fieldSetOf(c) + (kHasOpaque ? (grid.slabs + 1) * fieldNodes() : 0); }
uint fieldEnds() { return fieldSetOf(kSources + 1); }
uint fieldSpline(uint c) { return fieldEnds() + (c + (kHasOpaque ? 1 : 0)) * fieldNodes(); }

#include "shaders/lib/spline.glsl"
#include "shaders/lib/whole.glsl"

// Catmull-Rom's weights of the values at -1, 0, 1, 2.
vec4 through(float t) {
    return 0.5 * vec4(((2 - t) * t - 1) * t, (3 * t - 5) * t * t + 2, ((4 - 3 * t) * t + 1) * t, (t - 1) * t * t);
}

// Pixels side by side in one cell that are made together: the largest power of two that divides the rate, 8 at most.
const uint kRun = (kRate & 7u) == 0u ? 8u : kRate & (~kRate + 1u);
const uint kMostSources = 6;      // arrays have this size: GLSL does not copy those of specialised sizes

// Where a row of pixels in a cell lies among the nodes.
struct FieldRun {
    uint first; // node: up and left; at rate 1, where there is nothing to interpolate, the pixel's own
    float down; // part of the cell above it
};

// A pixel up or left of the picture by no more than a cell is allowed, too.
float fieldPart(int pixel) { return float(uint(pixel + int(kRate)) % kRate) / float(kRate); }

// Weights of a pixel's column among the four that its run has.
vec4 fieldAcross(int pixel) { return kRate == 1 ? vec4(1, 0, 0, 0) : spline(fieldPart(pixel)); }

FieldRun fieldRun(ivec2 pixel) {
    const uvec2 cell = uvec2(pixel + int(kRate)) / kRate + grid.margin - uvec2(0, grid.first_row) - (kRate == 1 ? 1 : 2);
    return FieldRun(cell.y * grid.nodes.x + cell.x, fieldPart(pixel.y));
}

// The nodes' four columns at the run's height. `plane`: where it begins.
vec4 fieldColumns(uint plane, FieldRun run, vec4 down) {
    const uint at = plane + run.first;
    if (kRate == 1) return vec4(field[at]);
    vec4 columns = vec4(0);
    for (uint j = 0; j < 4; ++j) {
        const uint row = at + j * grid.nodes.x;
        columns += down[j] * vec4(field[row], field[row + 1], field[row + 2], field[row + 3]);
    }
    return columns;
}

// The same of a spline for this row of pixels and the next one of the cell: .x and .y of every column.
mat4x2 fieldColumnsOfTwo(uint plane, FieldRun run, FieldRun next) {
    const uint at = plane + run.first;
    const vec4 here = spline(run.down), there = spline(next.down);
    mat4x2 columns = mat4x2(0);
    [[unroll]] for (uint j = 0; j < 4; ++j) {
        const uint row = at + j * grid.nodes.x;
        [[unroll]] for (uint i = 0; i < 4; ++i) columns[i] += field[row + i] * vec2(here[j], there[j]);
    }
    return columns;
}

// The columns of two neighbouring faces, kept while a run's pixels need the same ones.
struct FieldFaces {
    float below; // the nearer face; < 0: none yet
    vec4 near, far;
};

// Up to a face and parts of one, at a part of the cell's width. `set`: where its planes begin.
float fieldAt(inout FieldFaces faces, uint set, FieldRun run, float face, float part) {
    const float below = min(floor(face), float(grid.slabs - 1));
    if (below != faces.below) {
        const uint plane = set + nearestWhole(below) * fieldNodes();
        faces.near = fieldColumns(plane, run, through(run.down));
        faces.far = fieldColumns(plane + fieldNodes(), run, through(run.down));
        faces.below = below;
    }
    const vec4 columns = mix(faces.near, faces.far, face - below);
    return kRate == 1 ? columns.x : dot(through(part), columns);
}
