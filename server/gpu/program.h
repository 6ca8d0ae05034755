// Shader programs. What shaders read, by name, and the size of their push constants are read from the SPIR-V, and every
// use is checked against them.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/gpu/named_resources.h"
#include "shaders/shared/constants.h"

namespace brume::gpu {

class Commands;

struct ShaderCode {
    VkShaderStageFlagBits stage;
    std::span<const uint32_t> words;
    const char* name;
};

// The value of a specialization constant. Booleans and integers alike are 32 bits.
struct SpecConstant {
    uint32_t id; // from shaders/shared/constants.h
    uint32_t value;
};

struct Pipeline;

// A pipeline to be bound. Programs of the same shaders and constants share one, also with those that are gone
// (pipeline_cache.h). Images are always in VK_IMAGE_LAYOUT_GENERAL.
class Program {
public:
    Program() = default;

    // Binds pipeline, descriptors and push constants. What the shaders read is in `own`, else in `shared`. Throws Error
    // if neither has it, or if it is larger than the device can bind. Throws Error if the push constants have another
    // size.
    void bind(Commands& commands, const Resources& shared, std::span<const Resource> own,
              std::span<const std::byte> push) const;
    template <class Push>
    void bind(Commands& commands, const Resources& shared, std::initializer_list<Resource> own,
              const Push& push) const {
        bind(commands, shared, std::span(own.begin(), own.size()), std::as_bytes(std::span(&push, 1)));
    }
    void bind(Commands& commands, const Resources& shared, std::initializer_list<Resource> own) const {
        bind(commands, shared, std::span(own.begin(), own.size()), {});
    }
    template <class Push>
    void bind(Commands& commands, std::initializer_list<Resource> own, const Push& push) const {
        bind(commands, Resources(), own, push);
    }
    void bind(Commands& commands, std::initializer_list<Resource> own) const { bind(commands, Resources(), own); }
    explicit operator bool() const { return pipeline_ != nullptr; }

protected:
    explicit Program(std::shared_ptr<const Pipeline> pipeline) : pipeline_(std::move(pipeline)) {}

private:
    std::shared_ptr<const Pipeline> pipeline_; // also in the device's PipelineCache
};

class ComputeProgram : public Program {
public:
    ComputeProgram() = default;
    // Throws Error if the shader lacks the id of one of `constants`.
    ComputeProgram(const Device& device, const ShaderCode& shader, std::span<const SpecConstant> constants = {});
    ComputeProgram(const Device& device, const ShaderCode& shader, std::initializer_list<SpecConstant> constants)
        : ComputeProgram(device, shader, std::span(constants.begin(), constants.size())) {}
};

// How a draw changes a target's colour.
// - over: premultiplied, back to front. Colour = source + transmittance * colour; the shader writes the transmittance
//   as alpha. The target's alpha becomes the product of all transmittances.
// - replace: the source.
// - largest: the larger value in each channel.
enum class Blend { over, replace, largest };

struct GraphicsInfo {
    std::vector<VkFormat> formats{VK_FORMAT_R32G32B32A32_SFLOAT};       // one for each target
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST; // ignored with a mesh shader
    Blend blend = Blend::over;
};

// A program that draws into colour targets.
class GraphicsProgram : public Program {
public:
    GraphicsProgram() = default;
    GraphicsProgram(const Device& device, std::span<const ShaderCode> shaders, const GraphicsInfo& info,
                    std::span<const SpecConstant> constants = {});
};

} // namespace brume::gpu
