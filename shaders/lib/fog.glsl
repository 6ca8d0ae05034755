// Optical depths of all fogs of the tick together.
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/has_fog.glsl"
#include "shaders/shared/fog.h"
#include "shaders/shared/scatter.h"

const float kEndless = 1e30; // the end of a ray that nothing stops

const float kNoBall = 1e15;    // radius of a fog that fills no ball, and more

// True: there is one fog, without a ball.
bool isLoneFog() { return tick.fog_count == 1 && !(tick.fogs[0].radius < kNoBall); }

uint fogCount() { return kHasFog ? tick.fog_count : 0; } // loops over none are left out

// The part between `begin` and `end` of the ray origin + t dir in one fog.
FogPart partInFog(uint i, vec3 origin, vec3 dir, float begin, float end) {
    return insideFog(tick.fogs[i].lo, tick.fogs[i].hi, tick.fogs[i].centre, tick.fogs[i].radius, origin, dir, begin,
                     end);
}

// Optical depth of one fog on a part that lies in it. `metres`: length of `dir`.
float depthInFog(uint i, vec3 origin, vec3 dir, float metres, FogPart part) {
    return fogDepth(tick.fogs[i].sigma_t, tick.fogs[i].falloff, origin.y - tick.fogs[i].base, dir.y, metres,
                    part.begin, part.end);
}

// The end of a part, or the place before it behind which no more than e^-kDeep of the fog's light is seen.
const float kDeep = 60;
float seenEnd(uint i, vec3 origin, vec3 dir, float metres, FogPart part) {
    return min(part.end, part.begin + fogDistance(tick.fogs[i].sigma_t, tick.fogs[i].falloff,
                                                  origin.y - tick.fogs[i].base, dir.y, metres, part.begin, kDeep));
}

// Optical depth of all fogs between `begin` and `end` of the ray origin + t dir.
float fogBetween(vec3 origin, vec3 dir, float metres, float begin, float end) {
    float sum = 0;
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i)
        sum += depthInFog(i, origin, dir, metres, partInFog(i, origin, dir, begin, end));
    return min(sum, 1e18);
}

// Of each fog the integral of its extinction times the transmittance of all fogs from `begin` on, in [0, 1]: what it
// hides of what lies behind. Between two places where fogs begin or end, their extinctions are taken as proportional.
// Returns the optical depth of all of them, of which kDeep and more counts as one.
float fogShares(vec3 origin, vec3 dir, float metres, float begin, float end, out float shares[kMostFogs]) {
    FogPart parts[kMostFogs];
    [[dont_unroll]] for (uint i = 0; i < kMostFogs; ++i) {
        shares[i] = 0;
        parts[i] = FogPart(end, end);
        if (i < tick.fog_count) parts[i] = partInFog(i, origin, dir, begin, end);
    }
    if (tick.fog_count == 1) {
        const float depth = depthInFog(0, origin, dir, metres, parts[0]);
        shares[0] = opacity(depth);
        return depth;
    }
    [[dont_unroll]] for (uint i = 0; i < tick.fog_count; ++i) { // nothing is seen behind a deep one
        const float seen_end = seenEnd(i, origin, dir, metres, parts[i]);
        if (parts[i].end > parts[i].begin && seen_end < parts[i].end) end = min(end, seen_end);
    }
    float from = begin, passed = 0;
    [[dont_unroll]] for (uint piece = 0; piece < 2 * kMostFogs + 1 && from < end; ++piece) {
        float to = end; // the next place where a fog begins or ends
        [[dont_unroll]] for (uint i = 0; i < tick.fog_count; ++i) {
            if (parts[i].begin > from && parts[i].begin < parts[i].end) to = min(to, parts[i].begin);
            if (parts[i].end > from && parts[i].begin < parts[i].end) to = min(to, parts[i].end);
        }
        float own[kMostFogs], all = 0;
        [[dont_unroll]] for (uint i = 0; i < tick.fog_count; ++i) {
            const bool inside = parts[i].begin <= from && parts[i].end >= to && to > from;
            own[i] = inside ? depthInFog(i, origin, dir, metres, FogPart(from, to)) : 0;
            all = min(all + own[i], 1e18);
        }
        const float seen = exp(-passed) * phi(all);
        [[dont_unroll]] for (uint i = 0; i < tick.fog_count; ++i) shares[i] += seen * own[i];
        passed += all;
        from = to;
    }
    return passed;
}

// Optical depth of all fogs between a point and the sun.
float fogTowardSun(vec3 x) { return fogBetween(x, tick.sun.to_light, 1, 0, kEndless); }
