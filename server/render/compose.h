// The last passes of pictures: background, medium, tone map, and the planes that JPEG takes. Pixels whose medium comes as a field
// are made here and never stored as radiance, unless somebody wants to read it.
#pragma once

#include <map>

#include "server/render/picture.h"
#include "server/render/view_group.h"

namespace brume {

class Compose {
public:
    Compose(const gpu::Device& device, const SceneFeatures& features);

    // Whether EyeInputs::radiance holds what was composed afterwards: then every pixel is shaded, and groups are of one view. A
    // medium that was drawn is always there.
    void keepRadiance(bool keep) { keep_ = keep; }
    bool keepsRadiance() const { return keep_; }

    // Whether planes hold R, G, B of every pixel from now on (picture.h).
    void fullColour(bool full) { full_ = full; }

    // Pixels between those that are shaded (shading.h): 1 where a picture may have sharp edges, and while radiance is kept.
    // `deviation`: the medium's, in pixels.
    uint32_t stepOf(const EyeInputs& in, uint32_t rate, float deviation) const;
    // Words of the buffer that gpu::View::shaded points into.
    static uint32_t shadedWords(const gpu::View& view, uint32_t step);
    // Room for so many, nothing of this being on the device.
    void fit(VkDeviceSize shaded_words);

    // The medium is in EyeInputs::radiance, with what is behind it, of all pixels or of every EyeInputs::step-th.
    void record(gpu::Commands& commands, const EyeInputs& in);
    // The medium is in `field`. The background is in EyeInputs::radiance when the scene has opaque objects, else it is the sky.
    void record(gpu::Commands& commands, const ViewGroup& group, const gpu::Buffer& field);

private:
    struct Variant {
        bool drawn, keep, lobe, full;
        uint32_t rate, sources, step;
        auto operator<=>(const Variant&) const = default; // NOLINT(modernize-use-nullptr): clang-tidy 14 takes it for a 0
    };
    uint32_t blocksOf(uint32_t rate) const;
    const gpu::ComputeProgram& everyPixel(const Variant& variant);
    const gpu::ComputeProgram& someNodes(const Variant& variant);
    void recordShaded(gpu::Commands& commands, const ViewGroup& group, const gpu::Buffer& field);
    void recordDrawnNodes(gpu::Commands& commands, const EyeInputs& in);
    // From shaded nodes to planes.
    void recordPresent(gpu::Commands& commands, const gpu::Resource& views, const EyeInputs& any, uint32_t pass_view,
                       glm::uvec3 size, uint32_t step);

    const gpu::Device& device_;
    SceneFeatures features_;
    bool keep_ = false, full_ = false;
    gpu::Buffer none_; // where no field is
    gpu::Buffer shaded_;
    std::map<Variant, gpu::ComputeProgram> every_pixel_, some_nodes_;
    std::map<uint32_t, gpu::ComputeProgram> drawn_nodes_;              // by the step
    std::map<std::pair<uint32_t, bool>, gpu::ComputeProgram> present_; // by the step and fullColour()
};

} // namespace brume
