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

const uint kRun = 8;                                           // pixels side by side that are interpolated together
const uint kColumns = (kRate < kRun ? kRun / kRate : 1) + 3; // nodes that they need
const uint kRowsOfNodes = kRate == 1 ? 1 : 4;                 // where every pixel has its ray, there is nothing to interpolate
// Arrays have the largest size: GLSL does not copy those whose size is a specialisation constant.
const uint kMostColumns = 11, kMostSources = 6;

// Where a run of pixels lies among the nodes.
struct FieldRun {
    uint first; // node, up and left
    vec4 down;  // weights of the rows
};

FieldRun fieldRun(uvec2 pixel) {
    const uvec2 cell = pixel / kRate - uvec2(0, push.grid.first_row);
    return FieldRun((cell.y + (kRate == 1 ? 1 : 0)) * push.grid.nodes.x + cell.x, cubic(float(pixel.y % kRate) / float(kRate)));
}

// The nodes' columns at the run's height. `plane`: where it begins.
void fieldColumns(uint plane, FieldRun run, out float columns[kMostColumns]) {
    const uint at = plane + run.first;
    for (uint k = 0; k < kColumns; ++k) {
        columns[k] = 0;
        for (uint j = 0; j < kRowsOfNodes; ++j)
            columns[k] += (kRate == 1 ? 1 : run.down[j]) * field[at + j * push.grid.nodes.x + k];
    }
}

// At pixel `x` of the picture, the i-th of the run.
float fieldAcross(float columns[kMostColumns], uint x, uint i) {
    if (kRate == 1) return columns[i + 1];
    const vec4 across = cubic(float(x % kRate) / float(kRate));
    const uint k = kRate < kRun ? i / kRate : 0;
    return across.x * columns[k] + across.y * columns[k + 1] + across.z * columns[k + 2] + across.w * columns[k + 3];
}

// The columns of two neighbouring faces, kept while a run's pixels need the same ones.
struct FieldFaces {
    float below; // the nearer face; < 0: none yet
    float near[kMostColumns], far[kMostColumns];
};

// Up to a face and parts of one. `set`: where its planes begin.
float fieldAt(inout FieldFaces faces, uint set, FieldRun run, float face, uint x, uint i) {
    const float below = min(floor(face), float(push.grid.slabs - 1));
    if (below != faces.below) {
        fieldColumns(set + uint(below) * fieldNodes(), run, faces.near);
        fieldColumns(set + uint(below) * fieldNodes() + fieldNodes(), run, faces.far);
        faces.below = below;
    }
    return mix(fieldAcross(faces.near, x, i), fieldAcross(faces.far, x, i), face - below);
}
