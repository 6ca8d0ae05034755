#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Volumetric shadow map of a medium of tetrahedra: the optical depth between the light and every texel of every plane.
// A lane is a column of texels: it walks away from the light once. Depths at planes are exact.
#include "shaders/shared/constants.h"
#include "shaders/shared/tetrahedra.h"

layout(local_size_x = 8, local_size_y = 8) in;

#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Cells { Tetrahedron cells[]; };
layout(scalar) readonly buffer Faces { TetrahedraFace faces[]; };
layout(scalar) writeonly buffer Texels { vec4 texels[]; }; // [layer][row of the band][column]
layout(scalar) readonly buffer FaceNodes { ObjectNode face_nodes[]; };

layout(push_constant, scalar) uniform Push { TetrahedraBand band; } push;

const bool kOneAlbedo = true; // it is not read

#include "shaders/lib/tetrahedra.glsl"

// The planes of a column, written a layer at a time.
struct Column {
    uint texel;  // in the present layer
    uint stride; // texels from layer to layer
    uint plane;  // the next
    vec3 before; // the planes of the present layer before it
};

void put(inout Column column, float depth) {
    if (column.plane % 3 != 0) {
        column.before[column.plane % 3] = depth;
    } else {
        if (column.plane > 0) {
            texels[column.texel] = vec4(column.before, depth);
            column.texel += column.stride;
        }
        column.before.x = depth;
    }
    ++column.plane;
}

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    const uint columns = tick.map.texels.x, rows = min(push.band.rows, tick.map.texels.y - push.band.first_row);
    if (at.x >= columns || at.y >= rows) return;
    const vec2 part = (vec2(at) + vec2(0.5, float(push.band.first_row) + 0.5)) / vec2(tick.map.texels);
    const vec2 across = mix(tick.map.lo.xy, tick.map.hi.xy, part);
    const Line line = lineOf(across.x * tick.map.x + across.y * tick.map.y + tick.map.hi.z * tick.sun.to_light,
                             -tick.sun.to_light);
    const float step = (tick.map.hi.z - tick.map.lo.z) / float(tick.map.slices - 1);
    Column column = Column(at.y * columns + at.x, columns * rows, 0, vec3(0));
    const uint planes = 3 * push.band.layers + 1;
    float depth = 0;
    Walk walk;
    Entry entered = Entry(-kEndless, 0);
    bool inside = enterMesh(walk, line, push.band.faces, entered, kEndless, false);
    [[dont_unroll]] while (inside) {
        [[dont_unroll]] for (uint n = 0; walk.cell != kNoTetrahedron && n < cells.length(); ++n) {
            const bool placed = walk.placed;
            float t = walk.t;
            const float sigma = walk.sigma;
            passTetrahedron(walk, line);
            if (!placed) t = walk.t;
            const float length = walk.t - t, slope = (walk.sigma - sigma) / max(length, 1e-30);
            [[dont_unroll]] for (; column.plane < planes && float(column.plane) * step < walk.t;) {
                const float before = max(float(column.plane) * step - t, 0);
                put(column, depth + linearDepth(sigma, sigma + slope * before, before));
            }
            depth += linearDepth(sigma, walk.sigma, length);
        }
        inside = enterAgain(walk, line, push.band.faces, entered, kEndless);
    }
    [[dont_unroll]] while (column.plane < planes) put(column, depth);
}
