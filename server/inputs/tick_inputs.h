// What all eyes of one submission read: the scene, its particles, maps of light, the hue that is being recorded, and
// where finished pictures go.
#pragma once

#include <array>
#include <span>

#include "common/bounding_tree.h"
#include "common/scene.h"
#include "server/gpu/named_resources.h"
#include "server/inputs/scene_features.h"
#include "shaders/shared/types.h"

namespace brume {

struct TetrahedraBuffers; // server/inputs/tetrahedra_buffers.h
class VolumeBuffers;      // server/inputs/volume_buffers.h

struct TickInputs {
    const RenderSettings* settings = nullptr; // in use: every choice is made
    uint64_t number = 0;                      // number of the tick
    const gpu::Tick* tick = nullptr;          // the tick of all particles, on the CPU
    std::span<const gpu::LocalLight> lights;  // all points and spots, on the CPU
    Bounds3 objects_bounds;                   // bounds of boxes, spheres and meshes, m
    uint64_t objects_version = 0;             // a number that changes whenever an object does
    uint64_t sun_depth_version = 0;           // and one that changes whenever the depths of shadow_volume do
    uint32_t reflecting_count = 0;            // how many objects "Reflecting" has
    uint32_t bodies = 0;                      // number of boxes and spheres
    // For all passes, by the names that shaders give them:
    // - of the scene: Objects (planes come first), ObjectNodes (the tree of the others), Reflecting
    //   (reflectingObjects()), Triangles, MeshNodes (their tree, in several orders), LocalLights;
    // - maps of light: shadow_volume, opaque_shadow, mesh_heights, MeshPyramid, fluence, LightBits, LightDepths,
    //   UnionBits, UnionLights;
    // - of the pictures: LitByLocalLights and Sunlit of the last eye's pixels, Planes of all of them.
    gpu::Resources resources;
    const gpu::Buffer* particles = nullptr; // gpu::Particle[]: all of them
    const gpu::Sampler* nearest = nullptr;
    float lobe_width = 1;                          // rad, PhaseLobes::width()
    SceneFeatures features;                        // that shaders are compiled for
    bool needs_rays = true;                        // needsRays() the tick
    const TetrahedraBuffers* tetrahedra = nullptr; // null: the medium is not of tetrahedra
    const VolumeBuffers* volume = nullptr;         // null: the medium is no volume
    // True: the group was drawn in another hue just before. What no colour changes is there already.
    bool later_hue = false;
    uint32_t hue = 0;                                  // index of the hue that is drawn
    std::array<float, 1 + gpu::kMostFogs> hue_parts{}; // parts of the extinctions of particles and fogs that it has
    // True with opaque objects or keepRadiance(): pictures pass through RenderTarget one by one.
    bool uses_target = false;
};

} // namespace brume
