// Light of points and spots at the nodes of a particle's interval. Include after the eye.
#include "shaders/blocks/light_bits.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/local_lights.glsl"
#include "shaders/lib/local_light_depth.glsl"
#include "shaders/lib/occluded.glsl"
#include "shaders/lib/march_ray.glsl"
#include "shaders/lib/lamps_in_slice.glsl"

vec3 addedPart(uint i, vec3 x, vec3 away, float distance) { return vec3(arrivingPart(i, x, away, distance)); }
float litPart(uint i, vec3 x, vec3 away) { return isOccluded(x, -away, true) ? 0 : 1; }

// Places of the ray are metres from the eye from now on.
void aimLamps(vec3 unit) {
    ray_unit = unit;
    ray_metres = 1;
    of_particles = vec3(1);
}

const float kShortPart = 0.05; // of the distance from a light: its inverse square varies by 2e-4 of its mean at most

// What a medium of opacity and albedo 1 scatters at `place`, with the mean of each light's inverse square between
// `near` and `far`. A lamp inside a particle is far brighter at a node beside it than in what the node stands for.
vec3 lampsAround(float place, float near, float far) {
    const vec3 x = eye.position + place * ray_unit;
    const uint bin = binOf(uvec2(gl_FragCoord.xy));
    vec3 sum = vec3(0);
    [[dont_unroll]] for (uint word = 0; word < lightWords(); ++word)
        [[dont_unroll]] for (uint bits = light_bits[bin + word]; bits != 0; bits &= bits - 1) {
            const uint light = 32 * word + findLSB(bits);
            const bool is_short = far - near < kShortPart * length(x - local_lights[light].position);
            sum += is_short ? ofLightThere(light, x) : ofLightAround(light, x, near, far);
        }
    return sum;
}
