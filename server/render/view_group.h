// Views whose passes run together, one per z of their workgroups: of one medium, by the same programs.
#pragma once

#include <algorithm>

#include "server/render/method.h"

namespace brume {

struct ViewGroup {
    const EyeInputs* any = nullptr;   // one of them, for what all have in common
    std::span<const gpu::View> views; // as on the device
    gpu::Resource block;              // where they are there, binding 1
    uint32_t rate = 1, sources = 1;   // of their fields (shaders/lib/slab_field.glsl)
    uint32_t step = 1;                // pixels between those that are shaded
    VkDeviceSize bins = 0;            // words of bits, of all together
    // Where view `i` alone is.
    gpu::Resource blockOf(uint32_t i) const {
        gpu::Resource one = block;
        one.buffer.offset += i * sizeof(gpu::View);
        one.buffer.range = sizeof(gpu::View);
        return one;
    }
    uint32_t count() const { return uint32_t(views.size()); }
    uint32_t view() const { return count() == 1 ? any->view : gpu::kEach; } // for the passes' times
    // The largest of a number that each has.
    template <class Of>
    uint32_t most(Of of) const {
        uint32_t all = 0;
        for (const gpu::View& view : views) all = std::max(all, uint32_t(of(view)));
        return all;
    }
};

} // namespace brume
