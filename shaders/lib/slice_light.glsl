// Light of the sun and of all points and spots in a slice of a ray. Include after lib/froxel_light.glsl.
#include "shaders/blocks/light_bits.glsl"
#include "shaders/blocks/tick.glsl"

layout(constant_id = kIdLightsAtSample) const bool kLightsAtSample = false;

// The part of the sun's light that objects let through to x.
float sunlitPart(vec3 x);

// The same by the sun's shadow map; past meshes by a ray.
float sunlitByMap(vec3 x) {
    if (!(visibility(toLightSpace(x)) > 0)) return 0;
    return kHasMeshes && isShadowedByMesh(x, tick.sun.to_light, kFarAway, kInnerNode, 0) ? 0 : 1;
}

// Finds what the medium between two view depths scatters toward the eye, per unit of its own opacity over its depth,
// and its optical depth.
void addLight(float near, float far, inout vec3 scattered, out float depth) {
    depth = mediaOf(near, far, scattered);
    if (!(depth > 0)) return;
    const vec3 x = eye.position + sampledDepth(near, far) * ray_dir;
    if (tick.sun.irradiance != vec3(0)) {
        float through = sunThrough(x);
        if (through > 0 && kHasCasters) through *= sunlitPart(x);
        if (through > 0)
            scattered += tick.sun.irradiance * through * scatteredFrom(-tick.sun.to_light);
    }
    if (kHasLocalLights) {
        const uint bin = binOf(ray_pixel);
        [[dont_unroll]] for (uint word = 0; word < lightWords(); ++word)
            [[dont_unroll]] for (uint bits = light_bits[bin + word]; bits != 0; bits &= bits - 1) {
                const uint light = 32 * word + findLSB(bits);
                scattered += kLightsAtSample ? ofLightThere(light, x) : ofLocalLight(light, near, far);
            }
    }
}
