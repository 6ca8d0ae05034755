// Shader programs. The descriptor layout and the push constants come from the SPIR-V itself, and every use is checked against
// them.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "server/gpu/resource.h"
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
    uint32_t id; // of shaders/shared/constants.h
    uint32_t value;
};

// One descriptor of a pass.
struct Resource {
    uint32_t binding = 0;
    VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    VkDescriptorBufferInfo buffer{};
    VkDescriptorImageInfo image{};
};
Resource storageBuffer(uint32_t binding, const Buffer& buffer, VkDeviceSize offset = 0, VkDeviceSize size = VK_WHOLE_SIZE);
Resource uniformBuffer(uint32_t binding, const Buffer& buffer, VkDeviceSize offset, VkDeviceSize size);
Resource storageImage(uint32_t binding, const Image& image);
Resource sampledImage(uint32_t binding, const Image& image, const Sampler& sampler);

// Layout, pipeline and what the shaders expect. Images are always in VK_IMAGE_LAYOUT_GENERAL.
class Program {
public:
    Program() = default;
    ~Program();
    Program(Program&& other) noexcept { swap(other); }
    Program& operator=(Program&& other) noexcept {
        swap(other);
        return *this;
    }

    // Binds pipeline, descriptors and push constants. Throws Error when a resource that the shaders use is missing, of
    // another kind, or larger than the device can bind, or when the push constants have another size.
    void bind(Commands& commands, std::span<const Resource> resources, std::span<const std::byte> push) const;
    template <class Push>
    void bind(Commands& commands, std::initializer_list<Resource> resources, const Push& push) const {
        bind(commands, std::span(resources.begin(), resources.size()), std::as_bytes(std::span(&push, 1)));
    }
    void bind(Commands& commands, std::initializer_list<Resource> resources) const {
        bind(commands, std::span(resources.begin(), resources.size()), {});
    }
    explicit operator bool() const { return pipeline_ != VK_NULL_HANDLE; }

protected:
    // Throws Error when none of the shaders has a specialization constant with the id of one of `constants`.
    Program(const Device& device, std::span<const ShaderCode> shaders, std::span<const SpecConstant> constants,
            VkPipelineBindPoint bind_point);
    void swap(Program& other) noexcept;

    struct Expected {
        uint32_t binding;
        VkDescriptorType type;
        std::string name;
    };
    const Device* device_ = nullptr;
    VkPipelineBindPoint bind_point_ = VK_PIPELINE_BIND_POINT_COMPUTE;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkShaderStageFlags stages_ = 0;
    uint32_t push_bytes_ = 0;
    std::vector<Expected> expected_;
    std::string name_;

private:
    void reflect(const ShaderCode& shader, std::vector<uint32_t>& constant_ids);
    void createLayout();
    void checkRange(const Resource& given, const Expected& expected) const;
};

class ComputeProgram : public Program {
public:
    ComputeProgram() = default;
    ComputeProgram(const Device& device, const ShaderCode& shader, std::initializer_list<SpecConstant> constants = {});
};

// What becomes of a target's colour. Over: premultiplied, back to front, colour = source + transmittance * colour, where the
// shader writes the transmittance as alpha; the target's alpha gathers the product of transmittances.
enum class Blend { over, replace, largest };

struct GraphicsInfo {
    std::vector<VkFormat> formats{VK_FORMAT_R32G32B32A32_SFLOAT};       // of the targets
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST; // ignored with a mesh shader
    Blend blend = Blend::over;
};

// Draws into colour targets.
class GraphicsProgram : public Program {
public:
    GraphicsProgram() = default;
    GraphicsProgram(const Device& device, std::span<const ShaderCode> shaders, const GraphicsInfo& info,
                    std::span<const SpecConstant> constants = {});
};

} // namespace brume::gpu
