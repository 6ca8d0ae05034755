// The last pass of an eye: background, medium, tone map, and the planes that JPEG takes. Pixels whose medium comes as a field are
// made here from first to last and never stored as radiance, unless somebody wants to read it.
#pragma once

#include <map>

#include "server/render/method.h"
#include "server/render/picture.h"

namespace brume {

// The medium on a coarse grid of rays (shaders/lib/slab_field.glsl), of the whole picture or of a band of its rows.
struct MediumField {
    const gpu::Buffer* buffer = nullptr;
    gpu::SlabGrid grid{};
    uint32_t sources = 1;
};

class Compose {
public:
    Compose(const gpu::Device& device, const SceneFeatures& features);

    // Whether EyeInputs::radiance holds what was composed afterwards. A medium that was drawn is always there.
    void keepRadiance(bool keep) { keep_ = keep; }

    // Rows first ... first + count of the picture, both even but at its end. Without a field the medium is in
    // EyeInputs::radiance, with what is behind it. With one, the background is there when the scene has opaque objects, else it
    // is the sky.
    void record(gpu::Commands& commands, const EyeInputs& in, uint32_t first, uint32_t count, const MediumField* field);

private:
    struct Variant {
        bool drawn, keep, lobe;
        uint32_t rate, sources;
        auto operator<=>(const Variant&) const = default;
    };
    const gpu::ComputeProgram& program(const Variant& variant);

    const gpu::Device& device_;
    SceneFeatures features_;
    bool keep_ = false;
    gpu::Buffer none_; // where no field is
    std::map<Variant, gpu::ComputeProgram> programs_;
};

} // namespace brume
