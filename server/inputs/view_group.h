// Views whose passes run together, one for each z of their workgroups: of one medium, by the same programs.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "server/gpu/commands.h"
#include "server/inputs/eye_inputs.h"
#include "shaders/shared/field.h"

namespace brume {

struct ViewGroup {
    const EyeInputs* any = nullptr;           // an eye of the group; settings and medium are equal in all eyes
    std::span<const gpu::View> views;         // on the CPU: whole pictures, or bands of their rows
    gpu::Resource block;                      // the views on the device: Views
    gpu::Resources resources;                 // that; Field, where there is one; and those of `any`
    uint32_t rate = 1;                        // pixels between neighbouring rays of the fields
    gpu::FieldColours colours{1, 0, 0, 0, 0}; // of the fields (shaders/shared/field.h)
    uint32_t step = 1;                        // pixels between those that are shaded
    bool depth_layers = false;                // True: some of the views have layers with depth
    VkDeviceSize bins = 0;                    // 32-bit words of bin bits for all views together
    const gpu::Buffer* field = nullptr;       // rays of these views (shaders/shared/field.h), written by the method;
                                              // null: it draws into RenderTarget::radiance

    // View `i` alone on the device.
    gpu::Resource blockOf(uint32_t i) const {
        gpu::Resource one = block;
        one.buffer.offset += i * sizeof(gpu::View);
        one.buffer.range = sizeof(gpu::View);
        return one;
    }
    uint32_t count() const { return uint32_t(views.size()); }
    // PassSample::view of this group's passes: the view, or kEach for several.
    uint32_t view() const { return count() == 1 ? any->view : gpu::kEach; }
    // The largest of a number that each view has.
    template <class Of>
    uint32_t most(Of of) const {
        uint32_t all = 0;
        for (const gpu::View& view : views) all = std::max(all, uint32_t(of(view)));
        return all;
    }
};

// Words of gpu::View::shaded that a view needs when one pixel of step x step is shaded (shaders/lib/shaded.glsl).
inline uint32_t shadedWords(const gpu::View& view, uint32_t step) {
    return step == 1 ? 0
                     : 2 * (gpu::groups(view.eye.size.x, step) + 3) * (gpu::groups(view.end - view.first, step) + 3);
}

// The group of one eye whose medium is drawn into its target.
inline ViewGroup drawnAlone(const EyeInputs& in) {
    return {.any = &in,
            .views = {in.block, 1},
            .block = in.resources.storage("Views"),
            .resources = gpu::Resources(&in.resources),
            .step = in.step};
}
inline void drawnOneByOne(std::span<const EyeInputs> eyes, std::vector<ViewGroup>& groups) {
    groups.clear();
    for (const EyeInputs& in : eyes) groups.push_back(drawnAlone(in));
}

} // namespace brume
