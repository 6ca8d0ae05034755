// SlabRays: base of methods that integrate the medium along a coarse grid of rays cut into slabs. The medium's band
// limit says how many rays and slabs there are. Pictures are cut into bands of rows, so that no buffer grows with them.
// The result is the field of all rays, which Compose samples (shaders/lib/slab_march.glsl). Passes of several eyes run
// together.
#pragma once

#include "server/gpu/variants.h"
#include "server/inputs/constants.h"
#include "server/methods/method.h"

namespace brume {

class SlabRays : public Method {
public:
    explicit SlabRays(const MethodContext& context);

    MethodNeeds needs() const override { return {.writes_target = false}; }
    std::span<const ViewGroup> prepare(std::span<const EyeInputs> eyes) final;
    void recordGroup(gpu::Commands& commands, const ViewGroup& group) final;

protected:
    static constexpr uint32_t kRaysOfTile = gpu::kSlabTile * gpu::kSlabTile;

    // Elements of the buffers that gpu::View points into.
    struct Elements {
        VkDeviceSize members = 0, bins = 0, added = 0, field = 0, shaded = 0, layered = 0;
    };
    // What a band needs of the method's own buffers: members, bins, added.
    virtual Elements elementsOf(const EyeInputs&, const gpu::SlabGrid&) const { return {}; }
    // Makes the method's own buffers so large. Precondition: nothing of the method is on the device.
    virtual void growOwn(const Elements&) {}
    // Writes field_ for all rays of a group; earlier contents have been read. Its writes are visible to compute
    // afterwards.
    virtual void recordRays(gpu::Commands& commands, const ViewGroup& group) = 0;

    void grow(gpu::Buffer& buffer, VkDeviceSize bytes, const char* name) const;

    const gpu::Device& device_;
    const SceneFeatures features_;
    gpu::Buffer field_, layered_;

private:
    // How a picture is made: all of it, or one band of rows of tiles after the other.
    struct Bands {
        gpu::SlabGrid grid;
        uint32_t cells, step; // rows of cells: of the picture, and of one band
    };
    Bands bandsOf(const EyeInputs& in) const;
    static VkDeviceSize bytesOfLargest(const Elements& elements); // of the buffers
    uint32_t shadingStepOf(const EyeInputs& in, uint32_t rate) const;
    gpu::FieldColours coloursOf(const EyeInputs& in) const;
    VkDeviceSize fieldWords(const EyeInputs& in, const gpu::SlabGrid& grid) const;
    void addLayers(const EyeInputs& in, const Bands& bands, gpu::View& view, Elements& elements) const;
    // The view of `in` in rows of pixels from first_row on. It is put behind what is in `elements` already, which grows
    // by it.
    gpu::View viewOf(const EyeInputs& in, const Bands& bands, uint32_t first_row, uint32_t step,
                     Elements& elements) const;
    void group(std::span<const EyeInputs> eyes);
    // Writes which faces of the rays pixels read.
    void recordEnds(gpu::Commands& commands, const ViewGroup& group);
    void recordSpline(gpu::Commands& commands, const ViewGroup& group);

    std::vector<const EyeInputs*> order_; // eyes sorted so that those of one group are neighbours
    std::vector<gpu::View> views_;
    std::vector<size_t> firsts_; // of groups_, in views_
    gpu::Buffer views_buffer_;
    Elements most_; // of all groups
    gpu::Variants ends_, spline_;
};

} // namespace brume
