// The medium between the eye and any place of the picture, from a coarse grid of rays. Include after `field`, `push.grid`,
// kHasOpaque, kSources and kRate are declared. `field` holds sets of planes of nodes: a set of optical depths, then kSources sets of
// scattered light (rho p E = 1): one where all particles have one albedo; else what red, green and blue of it the albedos leave, and
// then the same of ambient light. A set is one plane without opaque objects: the whole ray. With them slabs + 1, one per face from
// near to far, then that of the ray up to the surface that it hits; and behind all sets a plane says at which face that is. What a
// whole ray scatters is divided by its opacity: both are then smooth where the medium is band-limited, however dense it is.

// Catmull-Rom: of the nodes at -1, 0, 1, 2.
vec4 cubic(float t) {
    return 0.5 * vec4(((2 - t) * t - 1) * t, (3 * t - 5) * t * t + 2, ((4 - 3 * t) * t + 1) * t, (t - 1) * t * t);
}

uint fieldNodes() { return push.grid.nodes.x * push.grid.nodes.y; }
uint fieldSet() { return (kHasOpaque ? push.grid.slabs + 2 : 1) * fieldNodes(); }

const uint kRun = kRate < 8 ? kRate : 8; // pixels side by side in one cell that are made together
const uint kMostSources = 6;      // arrays have this size: GLSL does not copy those of specialised sizes

// Where a run of pixels lies among the nodes.
struct FieldRun {
    uint first; // node: up and left; at rate 1, where there is nothing to interpolate, the pixel's own
    vec4 down;  // weights of the rows
};

FieldRun fieldRun(uvec2 pixel) {
    const uvec2 cell = pixel / kRate - uvec2(0, push.grid.first_row) + (kRate == 1 ? 1 : 0);
    return FieldRun(cell.y * push.grid.nodes.x + cell.x, cubic(float(pixel.y % kRate) / float(kRate)));
}

// The nodes' four columns at the run's height. `plane`: where it begins.
vec4 fieldColumns(uint plane, FieldRun run) {
    const uint at = plane + run.first;
    if (kRate == 1) return vec4(field[at]);
    vec4 columns = vec4(0);
    for (uint j = 0; j < 4; ++j) {
        const uint row = at + j * push.grid.nodes.x;
        columns += run.down[j] * vec4(field[row], field[row + 1], field[row + 2], field[row + 3]);
    }
    return columns;
}

// Weights of the columns for the pixel column `x` of the picture.
vec4 fieldAcross(uint x) { return kRate == 1 ? vec4(1, 0, 0, 0) : cubic(float(x % kRate) / float(kRate)); }

// The columns of two neighbouring faces, kept while a run's pixels need the same ones.
struct FieldFaces {
    float below; // the nearer face; < 0: none yet
    vec4 near, far;
};

// Up to a face and parts of one. `set`: where its planes begin.
float fieldAt(inout FieldFaces faces, uint set, FieldRun run, float face, vec4 across) {
    const float below = min(floor(face), float(push.grid.slabs - 1));
    if (below != faces.below) {
        const uint plane = set + uint(below) * fieldNodes();
        faces.near = fieldColumns(plane, run);
        faces.far = fieldColumns(plane + fieldNodes(), run);
        faces.below = below;
    }
    return dot(across, mix(faces.near, faces.far, face - below));
}
