// Hues: sets of channels in which all extinctions are alike. The medium is drawn once for each of them, as a grey one.
#pragma once

#include <array>
#include <vector>

#include "server/inputs/scene_features.h"
#include "shaders/shared/types.h"

namespace brume {

// Channels in which all extinctions are alike.
struct Hue {
    uint32_t channels = gpu::kAllChannels; // bits of red, green and blue
    float particles = 1;                   // part of the particles' extinction
    // Parts of the extinctions of gpu::Tick::fogs, in their order.
    std::array<float, gpu::kMostFogs> fogs{1, 1, 1, 1};

    // The tick as it is in these channels.
    gpu::Tick of(gpu::Tick tick) const {
        tick.channels = channels;
        tick.extinction = particles;
        for (uint32_t i = 0; i < tick.fog_count; ++i) tick.fogs[i].sigma_t *= fogs[i];
        return tick;
    }
};

static_assert(gpu::kMostFogs == 4); // as many ones as Hue::fogs begins with

// One to three hues that have all channels together, that of red first. `particles`: their number.
inline std::vector<Hue> huesOf(const Medium& medium, std::span<const Fog> fogs, uint32_t particles) {
    std::vector<Hue> hues;
    for (int channel = 0; channel < 3; ++channel) {
        Hue hue{.channels = 1u << channel};
        if (particles > 0) hue.particles = extinctionParts(medium.extinction_colour)[channel];
        uint32_t count = 0;
        for (const Fog& fog : fogs)
            if (isThere(fog) && count < gpu::kMostFogs)
                hue.fogs[count++] = extinctionParts(fog.extinction_colour)[channel];
        const auto alike = std::ranges::find_if(
            hues, [&](const Hue& h) { return h.particles == hue.particles && h.fogs == hue.fogs; });
        if (alike == hues.end())
            hues.push_back(hue);
        else
            alike->channels |= hue.channels;
    }
    return hues;
}
inline std::vector<Hue> huesOf(const SceneNow& now, uint32_t particles) {
    return huesOf(now.medium, now.lists.fogs, particles);
}

} // namespace brume
