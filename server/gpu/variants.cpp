#include "server/gpu/variants.h"

#include <algorithm>

#include "server/gpu/specialize.h"

namespace brume::gpu {

Variants::Variants(const Device& device, std::vector<ShaderCode> shaders, std::optional<GraphicsInfo> info)
    : device_(&device), shaders_(std::move(shaders)), info_(std::move(info)) {
    for (const ShaderCode& shader : shaders_)
        for (const uint32_t id : constantIds(shader.words))
            if (std::ranges::find(ids_, id) == ids_.end()) ids_.push_back(id);
    if (ids_.size() > kMostConstants)
        throw Error(std::string(shaders_.front().name) + ": too many specialization constants");
}

const Program& Variants::with(std::span<const SpecConstant> offered, std::span<const SpecConstant> own) {
    Key key;
    const auto take = [&](const SpecConstant& constant) {
        const auto at = std::ranges::find(ids_, constant.id);
        if (at != ids_.end()) key.set(size_t(at - ids_.begin()), constant.value);
        return at != ids_.end();
    };
    for (const SpecConstant& constant : offered) take(constant);
    for (const SpecConstant& constant : own)
        if (!take(constant)) throw unknownConstant(shaders_.front().name, constant.id);
    const auto found = std::ranges::find(made_, key, &Made::key);
    if (found != made_.end()) return found->program;
    Constants constants;
    for (size_t i = 0; i < ids_.size(); ++i)
        if (key.given >> i & 1) constants.push_back({ids_[i], key.values[i]});
    Program program = info_ ? Program(GraphicsProgram(*device_, shaders_, *info_, constants))
                            : Program(ComputeProgram(*device_, shaders_.front(), constants));
    return made_.emplace_back(Made{key, std::move(program)}).program;
}

} // namespace brume::gpu
