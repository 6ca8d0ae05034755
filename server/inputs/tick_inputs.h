// What all eyes of one submission share: the scene beside its particles, the light's maps, and where finished pictures
// go.
#pragma once

#include <array>
#include <span>

#include "common/bounding_tree.h"
#include "common/scene.h"
#include "server/gpu/resource.h"
#include "server/inputs/scene_features.h"
#include "shaders/shared/types.h"

namespace brume {

struct TetrahedraBuffers; // server/light/tetrahedra_buffers.h

struct TickInputs {
    const RenderSettings* settings = nullptr;  // in use: every choice is made
    uint64_t number = 0;                       // number of the tick
    const gpu::Tick* tick = nullptr;           // the tick of all particles, on the CPU
    std::span<const gpu::LocalLight> lights;   // all points and spots, on the CPU
    Bounds3 objects_bounds;                    // bounds of boxes, spheres and meshes, m
    uint64_t objects_version = 0;              // a number that changes whenever an object does
    const gpu::Buffer* objects = nullptr;      // gpu::Opaque[]: planes come first
    const gpu::Buffer* object_nodes = nullptr; // gpu::ObjectNode[]: the tree of the others
    const gpu::Buffer* reflecting = nullptr;   // uint32_t[]: reflectingObjects()
    uint32_t reflecting_count = 0;             // how many they are
    const gpu::Buffer* triangles = nullptr;    // gpu::Triangle[]: of meshes
    const gpu::Buffer* mesh_nodes = nullptr;   // gpu::ObjectNode[]: their tree, in gpu::kMeshOrders orders
    uint32_t bodies = 0;                       // number of the others: boxes and spheres
    const gpu::Buffer* local_lights = nullptr; // gpu::LocalLight[]
    const gpu::Buffer* light_bits = nullptr;   // LocalLights::bits()
    const gpu::Buffer* light_depths = nullptr; // LocalLights::depths()
    const gpu::Buffer* lit = nullptr;          // LocalLights::lit()
    const gpu::Buffer* sunlit = nullptr;       // Shafts::sunlit()
    const gpu::Image* shadow_volume = nullptr; // optical depth of the medium between the light and a place
    const gpu::Image* fluence = nullptr;       // Propagation::image()
    const gpu::Image* opaque_shadow = nullptr; // light-space height of the topmost caster
    const gpu::Image* mesh_heights = nullptr;  // MeshShadow::heights()
    const gpu::Buffer* mesh_pyramid = nullptr; // MeshShadow::pyramid()
    const gpu::Buffer* particles = nullptr;    // gpu::Particle[]: all of them
    const gpu::Buffer* union_bins = nullptr;   // UnionPath::bins()
    const gpu::Buffer* union_light = nullptr;  // gpu::ParticleLight[]: UnionPath's
    const gpu::Buffer* planes = nullptr;       // bytes of all finished pictures, each laid out as PlaneLayout says
    const gpu::Sampler* linear = nullptr;
    const gpu::Sampler* nearest = nullptr;
    float lobe_width = 1;                          // rad, PhaseLobes::width()
    SceneFeatures features;                        // that shaders are compiled for
    bool needs_rays = true;                        // needsRays() the tick
    const TetrahedraBuffers* tetrahedra = nullptr; // null: the medium is not of tetrahedra
    // True: the passes before were the same group's in another hue, and what no colour changes is there already.
    bool again = false;
    uint32_t hue = 0;                                  // index of the hue that is drawn
    std::array<float, 1 + gpu::kMostFogs> hue_parts{}; // parts of the extinctions of particles and fogs that it has
    // True with opaque objects or keepRadiance(): pictures pass through RenderTarget one by one.
    bool uses_target = false;
};

} // namespace brume
