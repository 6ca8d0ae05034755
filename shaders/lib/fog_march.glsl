// The part of fog in the march along a ray (lib/slab_march.glsl), and light depths on the ray. All places are view
// depths. Between two places the depth that light passes is taken as linear in the fog's own: exact for one fog that
// particles do not shadow. In their shadow, and in balls and behind them, an interval is cut into steps. Include after
// lib/eye.glsl, lib/light.glsl and lib/field_planes.glsl.
#include "shaders/blocks/tick.glsl"
#include "shaders/blocks/view_depth.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/field_scale.glsl"

const uint kMostFogSteps = 96;     // of one fog in a slab
const uint kMostFogPieces = kMostFogSteps + 2 * kMostFogs + 3; // the same, with those between the ends of fogs
const float kStepsOfRadius = 6;    // in a ball
const float kStepOfHeight = 0.2;     // of several fogs: most that a step changes the logarithm of an extinction by
const float kOpaque = 30;          // optical depth behind which nothing is seen

// The ray: its direction of unit view depth in the world and in the sun's map, and its length per unit of view depth.
vec3 march_dir, march_volume;
float march_length;

// Optical depth between the light and a point of the ray; finite, so that differences are numbers.
float lightAt(float depth) {
    const vec3 in_volume = map_rays.eye + depth * march_volume;
    if (!kHasFog) return min(lightDepth(in_volume), 1e18);
    return min(lightDepthAnywhere(in_volume) + fogTowardSun(eye.position + depth * march_dir), 1e18);
}

float surfaceDepth(vec2 pixel) {
    return texelFetch(view_depth, ivec2(clamp(pixel, vec2(0), vec2(eye.size) - 1)), 0).r;
}

float surface;                      // where the ray ends
float fog_place;                    // up to where fog is summed
uint fog_face;                      // the last face before that
float fog_passed, fog_own;          // optical depth of fog before the newest piece, and in it
float fog_light;                    // light depth at fog_place
bool fog_ended;                     // True: at_end has the ray's quantities where it ends
float at_end[kMostFieldQuantities];
float fog_phase[kMostFogs];

float fogOnRay(float begin, float end) { return fogBetween(eye.position, march_dir, march_length, begin, end); }

void startFog(float end) {
    surface = end;
    fog_face = 0;
    fog_place = faceDepth(0u);
    fog_passed = fog_own = 0;
    fog_ended = false;
    fog_light = lightAt(fog_place);
    [[dont_unroll]] for (uint i = 0; i < tick.fog_count; ++i) fog_phase[i] = fogPhase(i, march_dir / march_length);
}

// The part of `part` in which particles may stand between the ray and the sun.
FogPart shadowedPart(FogPart part) {
    const vec3 at = map_rays.eye, dir = march_volume;
    const vec2 inverse = 1 / mix(dir.xy, vec2(1e-20), lessThan(abs(dir.xy), vec2(1e-20)));
    const vec2 a = -at.xy * inverse, b = (1 - at.xy) * inverse;
    part.begin = max(part.begin, max(min(a.x, b.x), min(a.y, b.y)));
    part.end = min(part.end, min(max(a.x, b.x), max(a.y, b.y)));
    const float level = -at.z / (abs(dir.z) > 1e-20 ? dir.z : 1e-20);
    if (dir.z > 0) part.begin = max(part.begin, level);
    else part.end = min(part.end, level);
    return part;
}

// The part of `part` that lies in a fog's ball or behind it, where it hides and shadows others; some more on the ball's
// side toward the sun.
FogPart behindBall(uint i, FogPart part) {
    const vec3 sun = tick.sun.to_light, from = eye.position - tick.fogs[i].centre;
    const float radius = tick.fogs[i].radius, along = dot(from, sun), climb = dot(march_dir, sun);
    const vec3 dir = march_dir - climb * sun, at = from - along * sun; // across the sun's rays
    const float square = max(dot(dir, dir), 1e-12), closest = -dot(at, dir) / square;
    const vec3 off = at + closest * dir;
    const float beside = radius * radius - dot(off, off);
    if (!(beside > 0)) return FogPart(part.end, part.end);
    const float half_chord = sqrt(beside / square);
    part.begin = max(part.begin, closest - half_chord);
    part.end = min(part.end, closest + half_chord);
    const float level = (radius - along) / (abs(climb) > 1e-12 ? climb : 1e-12);
    if (climb > 0) part.end = min(part.end, level);
    else part.begin = max(part.begin, level);
    return part;
}

// Adds the light of all fogs between two places of the ray. particles: their optical depth there, which is spread
// evenly; before: optical depth in front of `from`; light_from, light_to: light depth at the ends.
void addFog(inout float sum[kMostFieldQuantities], float from, float to, float particles, float before,
            float light_from, float light_to) {
    if (before > kOpaque) return;
    const float transmittance = exp(-before), per_depth = particles / (to - from);
    [[dont_unroll]] for (uint i = 0; i < tick.fog_count; ++i) {
        const FogPart part = partInFog(i, eye.position, march_dir, from, to);
        if (!(part.end > part.begin)) continue;
        FogPart fine = shadowedPart(part); // where it is cut into steps
        float most = fine.end > fine.begin ? grid.fog_step : kEndless;
        [[dont_unroll]] for (uint j = 0; j < tick.fog_count; ++j) {
            FogPart other = part; // where fog j makes the depth that light passes vary
            float step = tick.fogs[j].radius / (kStepsOfRadius * march_length);
            if (tick.fogs[j].radius < kNoBall && j != i) other = behindBall(j, part);
            if (tick.fog_count > 1)
                step = min(step, kStepOfHeight / max(tick.fogs[j].falloff * abs(march_dir.y), 1e-30));
            if (!(other.end - other.begin > step)) continue;
            if (!(fine.end > fine.begin)) fine = other;
            fine = FogPart(min(fine.begin, other.begin), max(fine.end, other.end));
            most = min(most, step);
        }
        if (!(fine.end - fine.begin > most) || to >= kEndless) fine = FogPart(part.end, part.end);
        const float step = max(most, (fine.end - fine.begin) / float(kMostFogSteps));
        float a = from, depth_a = 0, light_a = light_from;
        [[dont_unroll]] for (uint n = 0; n < kMostFogPieces && a < part.end; ++n) {
            const bool inside = a >= part.begin; // False: the first piece ends where the fog begins
            float b = part.begin;
            if (inside) {
                b = a < fine.begin ? fine.begin : a < fine.end ? min(a + step, fine.end) : part.end;
                // The depth has kinks where other fogs begin or end.
                [[dont_unroll]] for (uint j = 0; j < tick.fog_count; ++j) {
                    const FogPart other = partInFog(j, eye.position, march_dir, a, part.end);
                    if (other.begin > a) b = min(b, other.begin);
                    if (other.end > a) b = min(b, other.end);
                }
                if (n == kMostFogPieces - 1 || !(b > a)) b = part.end;
                b = seenEnd(i, eye.position, march_dir, march_length, FogPart(a, b));
            }
            const float own =
                inside ? depthInFog(i, eye.position, march_dir, march_length, FogPart(a, b)) : 0;
            const float fogs = tick.fog_count == 1 ? own : fogOnRay(a, b);
            const float depth_b = depth_a + fogs + per_depth * (b - a);
            const float light_b = b == to ? light_to : lightAt(b);
            const float lit = transmittance * fog_phase[i] * scatterOwn(own, depth_a + light_a, depth_b + light_b);
            for (uint c = 0; c < 3; ++c) sum[fieldFog() + c] += tick.fogs[i].albedo[c] * lit;
            if (kAmbientColours > 0 || kHasGlow) {
                const float seen = transmittance * scatterOwn(own, depth_a, depth_b);
                for (uint c = 0; c < kAmbientColours; ++c) sum[fieldAmbient() + c] += tick.fogs[i].albedo[c] * seen;
                if (kHasGlow)
                    for (uint c = 0; c < 3; ++c) sum[fieldGlow() + c] += tick.fogs[i].emission[c] * seen;
            }
            if (own >= 0.99 * kDeep) break; // nothing is seen behind it
            a = b;
            depth_a = depth_b;
            light_a = light_b;
        }
    }
}

// Adds fog up to `face`, then that of the slab behind it, whose particles have optical depth `particles`; behind the
// last face of all, that on rays that go on, where the light is as at the face. `light_known`: with particles the light
// depth at the slab's far face. Where the ray ends in slabs of fog alone, the sum is kept. A loop of pieces, since
// addFog() takes long to compile.
void passFog(inout float sum[kMostFieldQuantities], uint face, float particles, float light_known) {
    [[dont_unroll]] while (fog_face <= face) {
        const bool in_slab = fog_face == face, goes_on = fog_face == lastFace();
        if (goes_on && (fog_ended || !(surface > fog_place))) break;
        const uint next = in_slab ? face + 1 : face;
        const float far = goes_on ? kEndless : faceDepth(next), passed = in_slab ? particles : 0;
        const bool alone = isFogAlone(fog_face) && isFogAlone(next - 1);
        const bool ends = kHasOpaque && !goes_on && alone && surface > fog_place && surface < far;
        const float to = ends ? surface : far;
        fog_passed += fog_own;
        fog_own = fogOnRay(fog_place, to);
        const float light = passed > 0 ? light_known : goes_on ? fog_light : lightAt(to);
        if (fog_own > 0) addFog(sum, fog_place, to, passed, sum[kFieldDepth] + fog_passed, fog_light, light);
        fog_light = light;
        fog_place = to;
        if (ends || goes_on) {
            at_end = sum;
            fog_ended = true;
        }
        if (!ends) fog_face = next;
    }
}
