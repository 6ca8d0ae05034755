// Method `sprites`: pictures of smoke that face the camera, one for each ball of a union medium, drawn far to near
// (Mattsson, Simulating Optical Depth for Participating Media Using Ray Tracing, Lund 2022). Each has one value of the
// sun's light, and six-way light maps.
#include <algorithm>
#include <cmath>
#include <utility>

#include "server/methods/proxies/raster.h"
#include "server/methods/sprites/puffs.h"
#include "shaders/sprite_frag.h"
#include "shaders/sprite_vert.h"

namespace brume::methods::sprites {
namespace {

// As shaders read it: side and frames, then of every texel the positive and the negative light.
gpu::Buffer bufferOf(const gpu::Device& device, const LightMaps& maps) {
    const uint32_t head[] = {maps.side, maps.frames};
    const size_t count = size_t(maps.frames) * maps.side * maps.side;
    gpu::Buffer buffer(device, sizeof(head) + 2 * count * sizeof(glm::vec4), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                       gpu::Memory::upload, "light maps");
    std::ranges::copy(head, buffer.mapped<uint32_t>(2).begin());
    const std::span<glm::vec4> texels = buffer.mapped<glm::vec4>(2 * count, sizeof(head));
    for (size_t i = 0; i < count; ++i) texels[2 * i] = maps.positive[i], texels[2 * i + 1] = maps.negative[i];
    buffer.flush();
    return buffer;
}

LightMaps mapsFor(const MethodContext& context) try {
    const std::string& maps = context.settings.sprites.maps;
    LightMaps all = maps == "files" ? mapsOf(context.sprite_maps) : maps == "even" ? evenMaps() : bakedMaps();
    // A particle's frame follows from its index. Where indices pass to others all have one frame.
    if (!context.same_particles) all.frames = 1;
    return all;
} catch (const std::runtime_error& error) {
    throw gpu::Error(error.what());
}

// SpritePush of shaders/lib/sprite.glsl.
glm::vec2 pushOf(const TickInputs& tick) {
    const SpritesSettings& settings = tick.settings->sprites;
    return {settings.size, settings.light == "path" ? 1 : 0};
}

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) {
    RasterInfo info;
    info.support = DepthOrder::Support::sprite;
    info.shaders = {{VK_SHADER_STAGE_VERTEX_BIT, sprite_vert, "sprite_vert"},
                    {VK_SHADER_STAGE_FRAGMENT_BIT, sprite_frag, "sprite_frag"}};
    info.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP;
    info.vertices = 4;
    info.needs = {.particle_light = true, .union_path = true};
    info.maps = bufferOf(context.device, mapsFor(context));
    info.push = pushOf;
    return makeRaster(context, std::move(info));
}

} // namespace brume::methods::sprites
