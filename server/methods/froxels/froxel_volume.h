// FroxelVolume: base of methods that march coarse rays through slices of an eye's view volume, and draw the result over
// the surfaces. Eyes, and bands of a picture's rows, use the same buffer one after the other.
#pragma once

#include <optional>

#include "server/gpu/variants.h"
#include "server/methods/method.h"
#include "server/methods/proxies/furthest_depths.h"
#include "shaders/shared/froxels.h"

namespace brume {

// Where the medium begins and ends before an eye, m of view depth. With fog it begins at the near plane, and ends
// behind all that is lit or hides it.
DepthRange mediumRange(const EyeInputs& in);

// Slices of one eye: the first at the near plane, or where the medium begins if there is no fog; the last one ends at
// FroxelSettings::far, or where the medium does. The last is up to 16 times as thick as the first.
gpu::FroxelGrid froxelSlices(const EyeInputs& in);

class FroxelVolume : public Method {
public:
    explicit FroxelVolume(const MethodContext& context);

    MethodNeeds needs() const override { return {.one_medium = true, .every_pixel = true}; }
    std::span<const ViewGroup> prepare(std::span<const EyeInputs> eyes) override;
    void recordGroup(gpu::Commands& commands, const ViewGroup& group) final;

protected:
    // Writes volume() for the rays of a band. Its writes are visible to compute afterwards.
    virtual void recordRays(gpu::Commands& commands, const EyeInputs& in, const gpu::FroxelGrid& froxels) = 0;

    const gpu::Buffer& volume() const { return volume_; } // vec4[face][row][column]: light, optical depth
    const gpu::Buffer& furthest() const;                  // float[tile]: FurthestDepths

    const gpu::Device& device_;
    const SceneFeatures features_;

private:
    gpu::Variants apply_;
    std::optional<FurthestDepths> furthest_; // with opaque objects
    gpu::Buffer volume_;
};

} // namespace brume
