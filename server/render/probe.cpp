#include "server/render/probe.h"

#include <algorithm>

#include "server/inputs/constants.h"
#include "shaders/probe_comp.h"

namespace brume {

Probe::Probe(const gpu::Device& device) : device_(device), program_(device, probe_comp, "probe") {}

std::span<const glm::vec4> ProbeReading::values() {
    if (pixels.empty()) return {};
    values_.invalidate();
    return values_.mapped<glm::vec4>(pixels.size());
}

void Probe::prepare(ProbeReading& reading) const {
    if (reading.pixels.size() > kMostProbes) throw gpu::Error("too many probes");
    if (reading.pixels.empty()) return;
    reading.where_.atLeast(device_, kMostProbes * sizeof(glm::uvec2), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                           gpu::Memory::upload, "probed pixels");
    reading.values_.atLeast(device_, kMostProbes * sizeof(glm::vec4), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                            gpu::Memory::readback, "probed values");
    std::ranges::copy(reading.pixels, reading.where_.mapped<glm::uvec2>(reading.pixels.size()).begin());
    reading.where_.flush();
}

void Probe::record(gpu::Commands& commands, const ViewGroup& group, ProbeReading& reading, const gpu::View& eye) {
    const EyeInputs& in = *group.any;
    reading.drawn = !group.field;
    for (uint32_t i = 0; i < group.count(); ++i) {
        if (group.views[i].planes != eye.planes) continue; // another eye's picture
        const gpu::Commands::Pass pass(commands, "probe", in.view);
        gpu::computeToCompute(commands.handle());
        const gpu::ProbePush push{.count = uint32_t(reading.pixels.size()),
                                  .rate = group.rate,
                                  .sun_colours = group.colours.sun,
                                  .ambient_colours = group.colours.ambient,
                                  .multiple_colours = group.colours.multiple,
                                  .step = group.step};
        const SceneFeatures features = reading.drawn ? SceneFeatures() : in.shared->features;
        program_.with(constantsOf(features), {{gpu::kIdDrawn, reading.drawn}})
            .bind(commands, group.resources,
                  {group.blockOf(i), gpu::storageBuffer("Pixels", reading.where_),
                   gpu::storageBuffer("Field", reading.drawn ? reading.where_ : *group.field),
                   gpu::storageBuffer("Values", reading.values_)},
                  push);
        vkCmdDispatch(commands.handle(), gpu::groups(push.count, 64), 1, 1);
        gpu::computeToHost(commands.handle());
    }
}

} // namespace brume
