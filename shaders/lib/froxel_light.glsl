// Light in a slice of a ray: what its media scatter of the sun and of points and spots, at the middle of the slice.
// Include after lib/march_ray.glsl, `bool hasParticles()`, lib/medium_nodes.glsl, kHasAmbient, lib/light.glsl,
// lib/local_lights.glsl, lib/local_light_depth.glsl and lib/occluded.glsl.
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/even_light.glsl"
#include "shaders/lib/lamps_in_slice.glsl"

const float kFarAway = 1e6; // m, where the sun's rays are taken to begin

// Optical depth of the particles in a slice, and the part of it that scatters each colour.
float particlesIn(float near, float far, out vec3 scattering);

// The same, if all is as at the slice's sample.
float particlesAtSample(float near, float far, out vec3 scattering) {
    const float metres = (far - near) * ray_metres;
    const float depth = metres * mediumAt(eye.position + sampledDepth(near, far) * ray_dir, scattering);
    scattering *= metres;
    return depth;
}

// Finds the media of a slice. Returns their optical depth; adds what they emit and scatter of ambient light.
float mediaOf(float near, float far, inout vec3 scattered) {
    of_particles = vec3(0);
    float depth = hasParticles() ? particlesIn(near, far, of_particles) : 0;
    scattered += evenLight(depth, of_particles);
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i) {
        const float own =
            depthInFog(i, eye.position, ray_dir, ray_metres, partInFog(i, eye.position, ray_dir, near, far));
        of_fogs[i] = own * tick.fogs[i].albedo;
        if (kHasAmbient) scattered += of_fogs[i] * tick.ambient;
        depth += own;
        if (kHasGlow) scattered += own * tick.fogs[i].emission;
    }
    return depth;
}

// The part of the sun's light that media let through to x.
float sunThrough(vec3 x) {
    const float toward = lightDepthAnywhere(toShadowVolume(x)) + (kHasFog ? fogTowardSun(x) : 0);
    return toward < 30 ? exp(-toward) : 0;
}
