// Looks the field up at a pixel's own surface, where it differs from that of the rays around it. Include after
// lib/medium_run.glsl.
#include "shaders/blocks/view_depth.glsl"
#include "shaders/lib/face_on_ray.glsl"

// True: a layer of a picture with glass is looked up. The field's rays end at surfaces, and pixels at sheets.
layout(constant_id = kIdHasGlass) const bool kIsLayer = false;

const float kSameHeight = 1e-2; // of a plane: most that its points differ by, as a part of their height
const float kSameFace = 0.1; // of a slab: most distance of the pixel's surface from that of its rays

// Values that pixels of a run share.
struct MediumCut { FieldFaces ended[kMostFieldQuantities]; };

// A quantity up to a face. Fog's columns are not kept for the next pixel: kept arrays of all its quantities take
// seconds to compile.
float cutAt(inout FieldFaces kept, uint quantity, MediumRun run, float face, float part) {
    if (!kHasFog) return fieldAt(kept, quantity, run.at, face, part);
    FieldFaces none;
    none.below = -1;
    return fieldAt(none, quantity, run.at, face, part);
}

// What a run begins with: nothing is known.
MediumCut mediumCut() {
    MediumCut cut;
    for (uint q = 0; q < fieldQuantities(); ++q) cut.ended[q].below = -1;
    return cut;
}

// True if the four nearest rays end on the same horizontal plane as the pixel, `height` above the eye, or in the sky.
// `behind`: true if all of them, and the pixel's own, at face `own`, end behind the particles.
bool isLevel(MediumRun run, ivec2 pixel, float height, float own, out bool behind) {
    const uvec2 first = fieldNode(pixel) + 1;
    const float last = float(grid.front + grid.slabs);
    bool level = true;
    behind = own >= last;
    [[dont_unroll]] for (uint n = 0; n < 4; ++n) {
        const uvec2 node = first + uvec2(n & 1, n >> 1);
        const float face = field[fieldEnd() + node.y * grid.nodes.x + node.x];
        const vec2 at = (vec2(node) + vec2(0, grid.first_row) - float(grid.margin)) * float(grid.rate) + 0.5;
        behind = behind && face >= last;
        const float there = faceDepth(face) * rayDirection(at).y;
        const bool in_sky = face >= float(lastFace()) && (!kIsLayer || own >= float(lastFace()));
        level = level && (in_sky || abs(there - height) < kSameHeight * abs(height));
    }
    return level;
}

// Changes the quantities of a whole ray (wholeRay()) to those of the pixel's own ray. `dir`: ray direction of unit view
// depth.
void cutRay(inout MediumCut cut, MediumRun run, ivec2 pixel, vec3 dir, vec4 across,
            inout float ray[kMostFieldQuantities]) {
    if (isFogOnly()) return; // it is the pixel's own
    const float part = fieldPart(pixel.x), z = texelFetch(view_depth, pixel, 0).r;
    const float linear = clamp(faceAt(z), 0, float(lastFace()));
    const bool differs = abs(dot(across, run.ends) - linear) > kSameFace;
    bool keep_fog = false, keep_all = false; // True: what is before the surface is that of the whole rays
    if (kHasFog && (run.steep || differs)) keep_fog = !differs;
    if (kHasFog && kRate > 1 && (run.steep || differs)) {
        const bool level = isLevel(run, pixel, z * dir.y, linear, keep_all);
        keep_fog = keep_fog || level;
        keep_all = keep_all && level;
    }
    if ((run.steep || differs) && !keep_all) {
        const float end = kHasFog ? faceOnRay(z, dir) : linear;
        for (uint q = 0; q < fieldQuantities(); ++q)
            if (isHeld(q) && !(keep_fog && q >= fieldFog())) ray[q] = max(cutAt(cut.ended[q], q, run, end, part), 0);
        if (kHasFog) ray[kFieldDepth] += fogBefore(dir, z);
    }
}
