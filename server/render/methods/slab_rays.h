// What methods have in common that integrate the medium along a coarse grid of rays cut into slabs (physics: "Order-independent
// slabs"): the rays and slabs that the medium's band limit asks for, bands of rows so that no buffer grows with the picture, the
// field of all rays (shaders/lib/slab_march.glsl), and compose.
#pragma once

#include <map>
#include <utility>

#include "server/render/compose.h"
#include "server/render/method.h"

namespace brume {

class SlabRays : public Method {
public:
    explicit SlabRays(const MethodContext& context) : device_(context.device), features_(context.features) {}

    bool composes() const final { return true; }
    void prepare(std::span<const EyeInputs> eyes) final;
    void record(gpu::Commands& commands, const EyeInputs& in) final;

protected:
    static constexpr uint32_t kRaysOfTile = gpu::kSlabTile * gpu::kSlabTile;

    // Bytes of the method's largest buffer that grows with a band's rays and slabs.
    virtual VkDeviceSize bandBytes(const gpu::SlabGrid&, uint32_t /*sources*/) const { return 0; }
    // Room for a band, nothing of the method being on the device.
    virtual void fitBand(const EyeInputs& in, const gpu::SlabGrid& grid, uint32_t sources) = 0;
    // Writes field() for the rays of a band; what was there has been read. Its writes are visible to compute afterwards.
    virtual void recordBand(gpu::Commands& commands, const EyeInputs& in, const gpu::SlabGrid& grid, uint32_t sources) = 0;

    // Sources of scattered light that are kept apart (shaders/lib/slab_field.glsl).
    uint32_t sources(const EyeInputs& in) const { return in.extent->one_albedo ? 1u : features_.ambient ? 6u : 3u; }
    void fit(gpu::Buffer& buffer, VkDeviceSize bytes, const char* name) const;
    // A program, made when it is first asked for: `variant` tells those of one shader apart.
    const gpu::ComputeProgram& made(std::span<const uint32_t> code, const char* name, uint32_t variant,
                                    std::initializer_list<gpu::SpecConstant> constants);

    const gpu::Device& device_;
    const SceneFeatures features_;
    gpu::Buffer field_;

private:
    // How a picture is made: all of it, or one band of rows of tiles after the other.
    struct Bands {
        gpu::SlabGrid grid;
        uint32_t cells, step; // rows of cells: all of them, and of one band
    };
    Bands bandsOf(const EyeInputs& in) const;
    void recordSpline(gpu::Commands& commands, const EyeInputs& in, const gpu::SlabGrid& grid);
    VkDeviceSize fieldBytes(const gpu::SlabGrid& grid, uint32_t sources) const;

    std::map<std::pair<const uint32_t*, uint32_t>, gpu::ComputeProgram> programs_;
};

} // namespace brume
