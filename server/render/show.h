// Show: draws views of how a picture is made over finished pictures (shaders/shared/show.h). It costs nothing while
// nobody looks at one.
#pragma once

#include <span>
#include <vector>

#include "server/gpu/variants.h"
#include "server/inputs/eye_request.h"
#include "server/inputs/view_group.h"
#include "server/render/legend.h"

namespace brume {

class Show {
public:
    explicit Show(const gpu::Device& device);

    // Takes what the eyes ask for. `full`: planes are R, G, B. Precondition: nothing of this is on the device.
    void prepare(std::span<const EyeRequest> eyes, bool full);
    // Draws over the planes of those of the group's views whose eye asks for it. To be called after they were composed,
    // in every hue, and before another group is drawn.
    void record(gpu::Commands& commands, const ViewGroup& group);
    void giveBack();

private:
    void makeLegends();
    LegendOf legendFor(const ViewGroup& group, const gpu::View& view, uint32_t discs) const;

    // One eye of the submission.
    struct Eye {
        uint32_t planes;       // gpu::View::planes
        uint32_t first, discs; // of `discs_`
    };

    const gpu::Device& device_;
    bool full_ = false, any_ = false; // any_: true if some eye asks for a view
    std::vector<Eye> eyes_;
    gpu::Buffer discs_, legends_;
    struct Placed {
        uint32_t first = 0; // word
        glm::uvec2 size{0};
    };
    std::vector<Placed> placed_; // of every legend in legends_
    // By view, fading, opaque, casters, full.
    gpu::Variants program_;
};

} // namespace brume
