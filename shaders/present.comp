#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Present, for views with band-limited pictures: interpolates all pixels by the cubic through the nodes of
// shade.comp. A lane makes 16x8 pixels, since its memory accesses cost more than its arithmetic.
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer Planes { uint planes[]; }; // lib/planes.glsl
layout(scalar) readonly buffer Shaded { uint shaded[]; };  // lib/shaded.glsl

#include "shaders/lib/cubic.glsl"
#include "shaders/lib/planes.glsl"
#include "shaders/lib/shaded.glsl"

const uint kWide = 16, kHigh = 8;
const uint kColumns = kWide / kStep + 3; // nodes along a lane's row
const uint kMostColumns = kWide / 2 + 3;

float along(float columns[kMostColumns], float x) { // x: pixels from the lane's first
    const uint first = uint(x / float(kStep));
    const vec4 w = cubic(fract(x / float(kStep)));
    return dot(w, vec4(columns[first], columns[first + 1], columns[first + 2], columns[first + 3]));
}

void main() {
    enterView(gl_WorkGroupID.z);
    const View view = views[gl_WorkGroupID.z];
    const uint block = gl_GlobalInvocationID.x * (kWide / 8), top = gl_GlobalInvocationID.y * kHigh,
               rows = view.end - view.first;
    if (block * 8 >= eye.size.x || top >= rows) return;
    const uvec2 nodes = shadedNodes(rows);
    // True: the second of the two blocks of 8 pixels is in the picture.
    const bool second = (block + 1) * 8 < eye.size.x;
    for (uint y = 0; y < kHigh; y += kStep) {
        if (top + y >= rows) break;
        vec4 luma[kMostColumns], cb[kMostColumns], cr[kMostColumns]; // interpolated from four rows of nodes
        [[unroll]] for (uint i = 0; i < kColumns; ++i)
            [[unroll]] for (uint j = 0; j < 4; ++j) {
            const uint at = view.shaded + ((top + y) / kStep + j) * nodes.x + min(block * 8 / kStep + i, nodes.x - 1);
            luma[i][j] = uintBitsToFloat(shaded[at]);
            const uint chroma = shaded[at + nodes.x * nodes.y];
            cb[i][j] = float(chroma & 0xffffu) / 256;
            cr[i][j] = float(chroma >> 16) / 256;
            }
        if (kFull) {
            for (uint row = y; row < y + kStep && top + row < rows; ++row) {
                float across[3][kMostColumns];
                const vec4 w = cubic(float(row - y) / float(kStep));
                [[unroll]] for (uint i = 0; i < kColumns; ++i) {
                    across[0][i] = dot(w, luma[i]);
                    across[1][i] = dot(w, cb[i]);
                    across[2][i] = dot(w, cr[i]);
                }
                [[unroll]] for (uint b = 0; b < kWide / 8; ++b) {
                    uvec2 words[3] = uvec2[](uvec2(0), uvec2(0), uvec2(0));
                    [[unroll]] for (uint n = 0; n < 8; ++n) {
                        const float x = float(8 * b + n);
                        const vec3 rgb = rgbOf(along(across[0], x), along(across[1], x), along(across[2], x));
                        [[unroll]] for (uint c = 0; c < 3; ++c) words[c][n / 4] |= byteOf(rgb[c], n);
                    }
                    if (b > 0 && !second) break;
                    [[unroll]] for (uint c = 0; c < 3; ++c) {
                        if ((tick.channels >> c & 1) == 0) continue;
                        const uint at = fullWord(view.planes, c, view.first + top + row, block + b);
                        planes[at] = words[c].x;
                        planes[at + 1] = words[c].y;
                    }
                }
            }
            continue;
        }
        for (uint row = y; row < y + kStep && top + row < rows; row += 2) {
            float here[kMostColumns], below[kMostColumns], cb_here[kMostColumns], cr_here[kMostColumns];
            const float part = float(row - y) / float(kStep), half_pixel = 0.5 / float(kStep);
            const vec4 w = cubic(part), w_below = cubic(part + 2 * half_pixel), w_between = cubic(part + half_pixel);
            [[unroll]] for (uint i = 0; i < kColumns; ++i) {
                here[i] = dot(w, luma[i]);
                below[i] = dot(w_below, luma[i]);
                cb_here[i] = dot(w_between, cb[i]);
                cr_here[i] = dot(w_between, cr[i]);
            }
            const bool odd = top + row + 1 >= rows;
            [[unroll]] for (uint b = 0; b < kWide / 8; ++b) {
                uint words[4] = uint[](0, 0, 0, 0), cb_word = 0, cr_word = 0;
                [[unroll]] for (uint n = 0; n < 8; ++n) {
                    words[n / 4] |= byteOf(along(here, float(8 * b + n)), n);
                    words[2 + n / 4] |= byteOf(along(below, float(8 * b + n)), n);
                }
                [[unroll]] for (uint n = 0; n < 4; ++n) {
                    cb_word |= byteOf(along(cb_here, float(8 * b + 2 * n) + 0.5), n);
                    cr_word |= byteOf(along(cr_here, float(8 * b + 2 * n) + 0.5), n);
                }
                if (b > 0 && !second) break;
                const uint at = lumaWord(view.planes, view.first + top + row, block + b);
                planes[at] = words[0];
                planes[at + 1] = words[1];
                if (!odd) {
                    planes[at + lumaWords()] = words[2];
                    planes[at + lumaWords() + 1] = words[3];
                }
                const uint chroma_at = chromaWord(view.planes, (view.first + top + row) / 2, block + b);
                planes[chroma_at] = cb_word;
                planes[chroma_at + crWords()] = cr_word;
            }
        }
    }
}
