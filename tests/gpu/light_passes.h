// Runs a single pass of the lighting, without the rest of a frame.
#pragma once

#include <algorithm>
#include <vector>

#include "server/effects/shadow_volume/shadow_volume.h"
#include "server/inputs/objects.h"
#include "server/inputs/tick_block.h"
#include "tests/gpu/fixture.h"

namespace brume::test {

// Records one pass with TickBlock and a buffer of that name with `elements`, submits it and waits.
template <class Element, class Record>
void recordAndWait(const gpu::Device& device, const gpu::Tick& tick, std::string_view name,
                   const std::vector<Element>& elements, const Record& record) {
    const gpu::Buffer block(device, sizeof(gpu::Tick), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, gpu::Memory::upload, "tick");
    const size_t count = std::max<size_t>(elements.size(), 1);
    const gpu::Buffer buffer(device, count * sizeof(Element), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload,
                             "elements");
    block.mapped<gpu::Tick>(1)[0] = tick;
    std::copy(elements.begin(), elements.end(), buffer.mapped<Element>(elements.size()).begin());
    gpu::Commands commands(device, "light");
    commands.begin();
    gpu::Resources shared;
    shared.give(gpu::uniformBuffer("TickBlock", block, 0, sizeof(gpu::Tick)));
    shared.give(gpu::storageBuffer(name, buffer));
    shared.give(gpu::storageBuffer("Axes", buffer)); // of balls nothing reads them
    record(commands, shared);
    commands.submit();
    waitFor(commands);
}

inline gpu::Tick tickOf(const Scene& scene, const std::vector<gpu::Particle>& particles) {
    return makeTick(scene, {scene.medium, sunOf(scene), listsOf(scene), scene.render, scene.simulation}, particles,
                    opaqueObjects(scene));
}

// The texels of all planes of `scene`'s volumetric shadow map, plane after plane, and its tick.
inline std::vector<float> shadowTexels(const gpu::Device& device, ShadowVolume& volume, const Scene& scene,
                                       const std::vector<gpu::Particle>& particles, gpu::Tick& tick) {
    tick = tickOf(scene, particles);
    recordAndWait(device, tick, "Particles", particles, [&](gpu::Commands& commands, gpu::Resources& shared) {
        EXPECT_TRUE(volume.record(commands, shared, tick));
    });
    const std::vector<float> stored = readImage(device, volume.image(), 4);
    const size_t area = size_t(tick.map.texels.x) * tick.map.texels.y;
    std::vector<float> texels(area * tick.map.slices);
    for (uint32_t plane = 0; plane < tick.map.slices; ++plane) {
        // Planes 3, 6, ... are in two layers: the last of one, the first of the next.
        for (uint32_t layer = 0; layer < volume.image().layers(); ++layer) {
            if (plane < 3 * layer || plane > 3 * layer + 3) continue;
            for (size_t i = 0; i < area; ++i) {
                const float value = stored[(layer * area + i) * 4 + (plane - size_t(3) * layer)];
                if (plane == 3 * layer && layer > 0) {
                    EXPECT_EQ(texels[plane * area + i], value) << "a shared plane differs";
                }
                texels[plane * area + i] = value;
            }
        }
    }
    return texels;
}

inline glm::dvec3 fromLightSpace(const gpu::Tick& tick, glm::dvec3 at) {
    return at.x * glm::dvec3(tick.map.x) + at.y * glm::dvec3(tick.map.y) + at.z * glm::dvec3(tick.sun.to_light);
}

} // namespace brume::test
