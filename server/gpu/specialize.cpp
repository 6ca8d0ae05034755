#include "server/gpu/specialize.h"

#include <string>
#include <unordered_map>

#include <spirv-tools/optimizer.hpp>

namespace brume::gpu {

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
