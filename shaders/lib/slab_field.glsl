// The field: the medium between the eye and points of the picture, from a coarse grid of rays, one per node. Include
// after lib/view.glsl, `field`, kHasOpaque, kSunColours, kAmbientColours and kRate are declared.
#include "shaders/lib/field_planes.glsl"
#include "shaders/lib/spline.glsl"
#include "shaders/lib/whole.glsl"

// Catmull-Rom: weights of the values at -1, 0, 1, 2.
vec4 through(float t) {
    return 0.5 * vec4(((2 - t) * t - 1) * t, (3 * t - 5) * t * t + 2, ((4 - 3 * t) * t + 1) * t, (t - 1) * t * t);
}

// Position of a row of pixels in a cell among the nodes.
struct FieldRun {
    uint first; // upper left node of the 4x4; at rate 1, without interpolation, the pixel's own
    float down; // part of the cell above the row, 0 ... 1
};

// The pixel's position in its cell, 0 ... 1. A pixel may be up or left of the picture by at most a cell.
float fieldPart(int pixel) { return float(uint(pixel + int(kRate)) % kRate) / float(kRate); }

// Weights of the run's four columns for a pixel.
vec4 fieldAcross(int pixel) { return kRate == 1 ? vec4(1, 0, 0, 0) : spline(fieldPart(pixel)); }

// The upper left one of the 4x4 nodes around a pixel.
uvec2 fieldNode(ivec2 pixel) {
    return uvec2(pixel + int(kRate)) / kRate + grid.margin - uvec2(0, grid.first_row) - (kRate == 1 ? 1 : 2);
}

FieldRun fieldRun(ivec2 pixel) {
    const uvec2 node = fieldNode(pixel);
    return FieldRun(node.y * grid.nodes.x + node.x, fieldPart(pixel.y));
}

// The values of four columns of nodes, interpolated to the run's height. `plane`: index of its first node.
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

// Two rows of pixels that are made together, the second below the first, and the weights of their rows of nodes. Cells
// of an even rate hold both rows or none.
struct FieldRows {
    FieldRun run, next;
    vec4 here, there;
};

FieldRows fieldRows(ivec2 pixel) {
    const FieldRun run = fieldRun(pixel), next = fieldRun(pixel + ivec2(0, 1));
    return FieldRows(run, next, spline(run.down), spline(next.down));
}

// The values of column `i` of four columns of nodes, interpolated to the heights of both rows by a B-spline.
vec2 fieldColumn(uint plane, FieldRows rows, uint i) {
    const uint upper = plane + rows.run.first + i, lower = plane + rows.next.first + i;
    if (kRate == 1) return vec2(field[upper], field[lower]);
    vec2 column = vec2(0);
    [[unroll]] for (uint j = 0; j < 4; ++j) {
        const float value = field[upper + j * grid.nodes.x];
        const float below = kRate % 2 == 0 ? value : field[lower + j * grid.nodes.x];
        column += vec2(rows.here[j] * value, rows.there[j] * below);
    }
    return column;
}

// Makes `columns` and `next` those of the upper and the lower row. `beside`: true if they are those of the cell to the
// left, so that only the last column is new.
void moveColumns(uint plane, FieldRows rows, bool beside, inout vec4 columns, inout vec4 next) {
    if (!beside && kRate > 1) {
        [[unroll]] for (uint i = 0; i < 3; ++i) {
            const vec2 column = fieldColumn(plane, rows, i);
            columns[i + 1] = column.x;
            next[i + 1] = column.y;
        }
    }
    const vec2 last = fieldColumn(plane, rows, kRate == 1 ? 0 : 3);
    columns = kRate == 1 ? vec4(last.x) : vec4(columns.yzw, last.x);
    next = kRate == 1 ? vec4(last.y) : vec4(next.yzw, last.y);
}

// The columns of four neighbouring faces, kept while the pixels of a run need the same faces.
struct FieldFaces {
    float below; // index of the second face; < 0: none yet
    mat4 columns;
};

// A quantity up to `face`, a fractional index, at `part` of the cell's width.
float fieldAt(inout FieldFaces faces, uint quantity, FieldRun run, float face, float part) {
    const float below = min(floor(face), float(lastFace() - 1));
    if (below != faces.below) {
        const uvec4 around = facesAround(nearestWhole(below));
        [[dont_unroll]] for (uint i = 0; i < 4; ++i) // compiles in half the time
            faces.columns[i] = fieldColumns(fieldFace(quantity, around[i]), run, through(run.down));
        faces.below = below;
    }
    const vec4 across = kRate == 1 ? vec4(1, 0, 0, 0) : through(part);
    return betweenFaces(across * faces.columns, face - below, nearestWhole(below));
}

// The same, linear between the four nearest rays: a quarter of the look-ups.
float fieldBetween(uint quantity, FieldRun run, float face, float part) {
    const float below = min(floor(face), float(lastFace() - 1));
    const uvec4 around = facesAround(nearestWhole(below));
    const uint inner = kRate == 1 ? run.first : run.first + grid.nodes.x + 1;
    vec4 values;
    [[unroll]] for (uint i = 0; i < 4; ++i) {
        const uint at = fieldFace(quantity, around[i]) + inner;
        if (kRate == 1) values[i] = field[at];
        else
            values[i] = mix(mix(field[at], field[at + 1], part),
                            mix(field[at + grid.nodes.x], field[at + grid.nodes.x + 1], part), run.down);
    }
    return betweenFaces(values, face - below, nearestWhole(below));
}
