// Shadow grids of small scenes, made and read back: what tests of the grid and of the frusta share.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "server/inputs/eye_block.h"
#include "server/inputs/local_light_block.h"
#include "server/methods/froxels/shadow_frustum.h"
#include "server/methods/froxels/shadow_grid.h"
#include "server/opaque/mesh_buffers.h"
#include "server/opaque/object_buffers.h"
#include "tests/gpu/light_passes.h"
#include "tools/reference/lighting.h"

// After it: the words of a shader need <cstdint>.
#include "test_shaders/shadow_frustum_read_comp.h"
#include "test_shaders/shadow_grid_read_comp.h"

namespace brume::test {
inline constexpr float kFar = 60;

inline Scene emptyScene() {
    Scene scene;
    scene.medium.layout = Layout::none;
    scene.lights = {Light{}};
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.4f, 0.8f, 0.3f));
    return scene;
}

// A ground, boxes and spheres of all sizes, some triangles, and lights of all kinds.
inline Scene crowdedScene(bool triangles) {
    Random random(5);
    Scene scene = emptyScene();
    scene.planes = {{-3.3f, glm::vec3(0.5f)}};
    for (int i = 0; i < 14; ++i) {
        scene.boxes.push_back({random.inCube(4),
                               {random.uniform(0.2f, 3), random.uniform(0.2f, 3), random.uniform(0.2f, 3)},
                               random.uniform(-3, 3),
                               glm::vec3(0.5f)});
        scene.spheres.push_back({random.inCube(4), random.uniform(0.1f, 1), glm::vec3(0.5f)});
    }
    for (int i = 0; triangles && i < 8; ++i) {
        const glm::vec3 at = random.inCube(4);
        scene.triangles.push_back({{at, at + random.inCube(1.5f), at + random.inCube(1.5f)}, glm::vec3(0.5f)});
    }
    scene.lights.push_back({.type = kPoint, .position = {0.3f, 3.9f, 0.2f}, .intensity = glm::vec3(5)});
    scene.lights.push_back({.type = kPoint, .position = {1, 0, 1}, .shadows = false});
    scene.lights.push_back({.type = kSpot, .position = {-5, 3, 2}, .intensity = glm::vec3(50)});
    scene.lights.push_back({.type = kPoint, .position = {2, -5, -1}, .intensity = glm::vec3(7)});
    return scene;
}

// A grid with what it is made from, for one scene whose lights and settings may change.
class Gridded {
public:
    Gridded(const gpu::Device& device, const Scene& scene, glm::vec3 lo, glm::vec3 hi)
        : device_(device), lo_(lo), hi_(hi), scene_(scene), grid_(device), objects_(device, scene),
          meshes_(device, scene.triangles),
          read_(device, {VK_SHADER_STAGE_COMPUTE_BIT, shadow_grid_read_comp, "shadow_grid_read"}) {}

    Scene& scene() { return scene_; }
    const ShadowGrid& grid() const { return grid_; }
    void changeObjects() { ++key_; }
    // Shadow rays of one call.
    uint64_t record(std::span<const gpu::Eye> eyes) {
        run([&](gpu::Commands& commands, const ShadowGridInputs& in) { grid_.record(commands, in); }, eyes);
        return grid_.raysSince();
    }
    uint64_t recordAll() {
        const std::vector<gpu::Eye> eyes(gpu::kMostShadowEyes + 1);
        return record(eyes);
    }
    void poison(uint32_t word) {
        run(
            [&](gpu::Commands& commands, const ShadowGridInputs&) {
                vkCmdFillBuffer(commands.handle(), grid_.voxels().handle(), 0, VK_WHOLE_SIZE, word);
                gpu::everythingBefore(commands.handle());
            },
            {});
    }
    std::vector<uint8_t> voxels() {
        const gpu::ShadowGridBlock& shape = grid_.shape();
        const size_t bytes = size_t(shape.bricks.x) * shape.bricks.y * shape.bricks.z * 512 * shape.stride;
        const gpu::Buffer back(device_, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback, "voxels");
        run(
            [&](gpu::Commands& commands, const ShadowGridInputs&) {
                const VkBufferCopy copy{0, 0, bytes};
                vkCmdCopyBuffer(commands.handle(), grid_.voxels().handle(), back.handle(), 1, &copy);
                gpu::transferToHost(commands.handle());
            },
            {});
        back.invalidate();
        const auto mapped = back.mapped<uint8_t>(bytes);
        return {mapped.begin(), mapped.end()};
    }
    // litInGrid() of the places; -1 outside.
    std::vector<float> look(uint32_t slot, const std::vector<glm::vec3>& places) {
        const gpu::Buffer from(device_, places.size() * sizeof(glm::vec3), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                               gpu::Memory::upload, "places");
        std::ranges::copy(places, from.mapped<glm::vec3>(places.size()).begin());
        const gpu::Buffer to(device_, places.size() * sizeof(float), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                             gpu::Memory::readback, "lit");
        const auto count = uint32_t(places.size());
        run(
            [&](gpu::Commands& commands, const ShadowGridInputs&) {
                read_.bind(commands,
                           {gpu::uniformBuffer("GridBlock", grid_.block(), 0, sizeof(gpu::ShadowGridBlock)),
                            gpu::storageBuffer("Voxels", grid_.voxels()), gpu::storageBuffer("Places", from),
                            gpu::storageBuffer("Lit", to)},
                           glm::uvec2(count, slot));
                vkCmdDispatch(commands.handle(), gpu::groups(count, 64), 1, 1);
                gpu::computeToHost(commands.handle());
            },
            {});
        to.invalidate();
        const auto mapped = to.mapped<float>(places.size());
        return {mapped.begin(), mapped.end()};
    }

    // The lights' bits of all froxels of eye `view`, [slice][row][column].
    std::vector<uint32_t> frustum(ShadowFrusta& frusta, std::span<const gpu::Eye> eyes, const ShadowSlices& slices,
                                  uint32_t view) {
        const uint32_t pixels = ShadowFrusta::kPixels, columns = gpu::groups(eyes[view].size.x, pixels),
                       count = columns * gpu::groups(eyes[view].size.y, pixels) * slices.count;
        const gpu::Buffer to(device_, count * sizeof(uint32_t), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                             gpu::Memory::readback, "lit");
        const gpu::ComputeProgram read(device_,
                                       {VK_SHADER_STAGE_COMPUTE_BIT, shadow_frustum_read_comp, "shadow_frustum_read"});
        run(
            [&](gpu::Commands& commands, const ShadowGridInputs& in) {
                grid_.record(commands, in);
                frusta.record(commands, in.resources, in.shared, grid_, eyes, {&slices, 1});
                read.bind(commands,
                          {gpu::storageBuffer("Frusta", frusta.frusta()),
                           gpu::storageBuffer("Froxels", frusta.froxels()), gpu::storageBuffer("Lit", to)},
                          glm::uvec2(view, columns));
                vkCmdDispatch(commands.handle(), gpu::groups(count, 64), 1, 1);
                gpu::computeToHost(commands.handle());
            },
            {});
        to.invalidate();
        const auto mapped = to.mapped<uint32_t>(count);
        return {mapped.begin(), mapped.end()};
    }

    static size_t voxelAt(const gpu::ShadowGridBlock& shape, glm::uvec3 voxel) {
        const glm::uvec3 brick = voxel / 8u, local = voxel % 8u;
        const size_t at = (size_t(brick.z) * shape.bricks.y + brick.y) * shape.bricks.x + brick.x;
        return 512 * at + 64 * size_t(local.z) + 8 * size_t(local.y) + local.x;
    }

private:
    using Recorded = std::function<void(gpu::Commands&, const ShadowGridInputs&)>;
    void run(const Recorded& recorded, std::span<const gpu::Eye> eyes) {
        std::vector<gpu::LocalLight> lights;
        for (const Light& light : localLightsOf(scene_)) lights.push_back(localLightBlock(light));
        const gpu::Tick tick = tickOf(scene_, {});
        const TickInputs inputs{.settings = &scene_.render, .features = {.meshes = !scene_.triangles.empty()}};
        recordAndWait(device_, tick, "LocalLights", lights, [&](gpu::Commands& commands, gpu::Resources& shared) {
            shared.give(gpu::storageBuffer("Objects", objects_.objects()));
            shared.give(gpu::storageBuffer("ObjectNodes", objects_.nodes()));
            shared.give(gpu::storageBuffer("Triangles", meshes_.triangles));
            shared.give(gpu::storageBuffer("MeshNodes", meshes_.nodes));
            recorded(commands, {.resources = shared,
                                .tick = tick,
                                .shared = inputs,
                                .lights = lights,
                                .lo = lo_,
                                .hi = hi_,
                                .eyes = eyes,
                                .far = kFar,
                                .key = key_});
        });
    }

    const gpu::Device& device_;
    glm::vec3 lo_, hi_;
    Scene scene_;
    ShadowGrid grid_;
    ObjectBuffers objects_;
    MeshBuffers meshes_;
    gpu::ComputeProgram read_;
    uint64_t key_ = 0;
};

inline bool isInSolid(const reference::World& world, glm::dvec3 x) {
    for (const reference::Obstacle& o : world.obstacles) {
        const glm::dvec3 from = x - o.centre;
        const double c = std::cos(o.yaw), s = std::sin(o.yaw);
        if (o.kind == reference::Obstacle::Kind::sphere && glm::length(from) < o.half_size.x) return true;
        const glm::dvec3 own = glm::abs(glm::dvec3(c * from.x - s * from.z, from.y, s * from.x + c * from.z));
        if (o.kind == reference::Obstacle::Kind::box && glm::all(glm::lessThan(own, o.half_size))) return true;
    }
    return false;
}

} // namespace brume::test
