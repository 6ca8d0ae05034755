// The last passes of pictures: background, medium, tone map, and the planes of bytes that the encoders take. Pixels
// whose medium comes as a field are made here and never stored as radiance, unless somebody wants to read it.
#pragma once

#include "server/gpu/variants.h"
#include "server/inputs/scene_features.h"
#include "server/inputs/view_group.h"
#include "server/render/show.h"

namespace brume {

class Compose {
public:
    explicit Compose(const gpu::Device& device);

    // True: RenderTarget::radiance holds the composed picture afterwards; every group is then of one view, with step 1.
    // A medium that was drawn is always there.
    void keepRadiance(bool keep) { keep_ = keep; }
    bool keepsRadiance() const { return keep_; }
    // True: planes hold R, G, B of every pixel from now on; false: Y, Cb, Cr (picture.h).
    void fullColour(bool full) { full_ = full; }

    uint64_t pictureBytes() const { return shaded_.size(); }
    void giveBack() { shaded_ = {}, show_.giveBack(); }
    // Makes room for the groups' shaded nodes, and takes which views the eyes ask for. Precondition: nothing of this is
    // on the device.
    void prepare(std::span<const ViewGroup> groups, std::span<const EyeRequest> eyes);
    // Writes the planes of a group's views. The medium is in the group's field, or with what is behind it in the
    // target. What is behind a field is in the target when the scene has opaque objects; else it is the sky. A view
    // that an eye asks for is drawn over its planes. In scenes with glass a field goes into the target alone, and not
    // into the planes.
    void record(gpu::Commands& commands, const ViewGroup& group);

private:
    static uint32_t blocksOf(const SceneFeatures& features, uint32_t rate);
    void recordEveryPixel(gpu::Commands& commands, const ViewGroup& group);
    void shadeField(gpu::Commands& commands, const ViewGroup& group);
    void shadeTarget(gpu::Commands& commands, const ViewGroup& group);
    // From shaded nodes to planes.
    void present(gpu::Commands& commands, const ViewGroup& group);

    const gpu::Device& device_;
    Show show_;
    bool keep_ = false, full_ = false;
    gpu::Buffer none_; // bound where there is no field
    gpu::Buffer shaded_;
    gpu::Variants every_pixel_, some_nodes_, drawn_nodes_, present_;
};

} // namespace brume
