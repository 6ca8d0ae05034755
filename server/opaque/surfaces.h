// The first pass of every eye: sky and opaque objects, with the shadows that objects and medium throw on them.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "server/gpu/commands.h"
#include "server/gpu/variants.h"
#include "server/inputs/eye_inputs.h"
#include "server/inputs/eye_request.h"
#include "server/opaque/object_buffers.h"

namespace brume {

class Surfaces {
public:
    // Compiled for as many objects: kinds that there are none of cost nothing. CPU drivers draw several times faster
    // into targets than they store to images; on some GPUs compute is far faster than draws.
    // `meshes`: true if the scene has some.
    Surfaces(const gpu::Device& device, const ObjectCounts& objects, bool meshes)
        : Surfaces(device, objects, meshes, device.isCpu()) {}
    Surfaces(const gpu::Device& device, const ObjectCounts& objects, bool meshes, bool by_draw);

    // Makes room for pictures of these eyes and these objects. Other numbers of boxes and spheres than at first are
    // looked for in bins, as many objects are: one more then needs no other shader. `all`: the objects, planes first.
    // Precondition: nothing of it is on the device.
    void prepare(std::span<const EyeRequest> eyes, const ObjectCounts& objects, std::span<const gpu::Opaque> all);
    // Writes all of the eye's target, with transmittance 1. Every kind of pass may read and write it afterwards.
    void record(gpu::Commands& commands, const EyeInputs& in);

private:
    bool isMany() const;
    void writeOrder(std::span<const EyeRequest> eyes, std::span<const gpu::Opaque> all);
    gpu::Resource orderOf(const EyeInputs& in) const;
    void recordBins(gpu::Commands& commands, const EyeInputs& in);

    const gpu::Device& device_;
    const ObjectCounts first_;
    ObjectCounts objects_;
    const bool meshes_, by_draw_;
    gpu::Variants bins_program_, program_;
    gpu::Buffer bins_;  // uint[bins][words]: which of many the rays of a bin of the last eye's pixels may hit
    gpu::Buffer order_; // uint[eyes][kMostBodies]: indices of boxes and spheres, the nearest first
    std::vector<std::pair<float, uint32_t>> nearest_; // scratch of writeOrder()
};

} // namespace brume
