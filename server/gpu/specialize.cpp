#include "server/gpu/specialize.h"

#include <algorithm>
#include <string>
#include <unordered_map>

#include <spirv-tools/optimizer.hpp>
#include <spirv.h>

namespace brume::gpu {

std::vector<uint32_t> constantIds(std::span<const uint32_t> words) {
    constexpr size_t kHeader = 5; // words before the first instruction; an instruction says how many words it has
    std::vector<uint32_t> ids;
    for (size_t at = kHeader; at < words.size(); at += std::max(words[at] >> 16, 1u))
        if ((words[at] & 0xFFFF) == SpvOpDecorate && at + 3 < words.size() && words[at + 2] == SpvDecorationSpecId)
            ids.push_back(words[at + 3]);
    return ids;
}

Error unknownConstant(const std::string& program, uint32_t id) {
    return Error(program + ": no shader has a specialization constant with the id " + std::to_string(id) +
                 " (shaders/shared/constants.h)");
}

std::vector<uint32_t> specialized(const ShaderCode& shader, std::span<const SpecConstant> constants) {
    std::unordered_map<uint32_t, std::vector<uint32_t>> values;
    for (const SpecConstant& constant : constants) values[constant.id] = {constant.value};
    std::string said;
    spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_3);
    optimizer.SetMessageConsumer([&](spv_message_level_t, const char*, const spv_position_t&, const char* message) {
        said += std::string(": ") + message;
    });
    optimizer.RegisterPass(spvtools::CreateSetSpecConstantDefaultValuePass(values))
        .RegisterPass(spvtools::CreateFreezeSpecConstantValuePass())
        .RegisterPass(spvtools::CreateFoldSpecConstantOpAndCompositePass())
        .RegisterPass(spvtools::CreateDeadBranchElimPass())
        .RegisterPass(spvtools::CreateEliminateDeadFunctionsPass());
    spvtools::OptimizerOptions options;
    options.set_run_validator(false); // the shaders are of this program
    std::vector<uint32_t> words;
    if (!optimizer.Run(shader.words.data(), shader.words.size(), &words, options))
        throw Error(std::string(shader.name) + ": its constants cannot be set" + said);
    return words;
}

} // namespace brume::gpu
