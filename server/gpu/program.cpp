#include "server/gpu/program.h"

#include <algorithm>
#include <utility>

#include <spirv_cross_c.h>

#include "server/gpu/commands.h"
#include "server/gpu/pipeline_cache.h"
#include "server/gpu/specialize.h"

namespace brume::gpu {
namespace {

constexpr size_t kMaxBindings = 24;

struct ShaderModule {
    VkDevice device;
    VkShaderModule handle = VK_NULL_HANDLE;
    ShaderModule(VkDevice owner, const ShaderCode& code, std::span<const SpecConstant> constants) : device(owner) {
        const std::vector<uint32_t> words = specialized(code, constants);
        VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
        info.codeSize = words.size() * sizeof(uint32_t);
        info.pCode = words.data();
        check(vkCreateShaderModule(device, &info, nullptr, &handle), code.name);
    }
    ~ShaderModule() { vkDestroyShaderModule(device, handle, nullptr); }
    ShaderModule(const ShaderModule&) = delete;
    ShaderModule& operator=(const ShaderModule&) = delete;
};

std::string textOf(std::string text, std::span<const SpecConstant> constants) {
    for (const SpecConstant& c : constants) text += ' ' + std::to_string(c.id) + '=' + std::to_string(c.value);
    return text;
}

const char* typeName(VkDescriptorType type) {
    switch (type) {
    case VK_DESCRIPTOR_TYPE_STORAGE_BUFFER:
        return "storage buffer";
    case VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER:
        return "uniform buffer";
    case VK_DESCRIPTOR_TYPE_STORAGE_IMAGE:
        return "storage image";
    default:
        return "sampled image";
    }
}

} // namespace

Resource storageBuffer(uint32_t binding, const Buffer& buffer, VkDeviceSize offset, VkDeviceSize size) {
    if (size == VK_WHOLE_SIZE) size = buffer.size() - offset;
    return {binding, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, {buffer.handle(), offset, size}, {}};
}
Resource uniformBuffer(uint32_t binding, const Buffer& buffer, VkDeviceSize offset, VkDeviceSize size) {
    return {binding, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, {buffer.handle(), offset, size}, {}};
}
Resource storageImage(uint32_t binding, const Image& image) {
    return {binding, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, {}, {VK_NULL_HANDLE, image.view(), VK_IMAGE_LAYOUT_GENERAL}};
}
Resource sampledImage(uint32_t binding, const Image& image, const Sampler& sampler) {
    return {binding,
            VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
            {},
            {sampler.handle(), image.view(), VK_IMAGE_LAYOUT_GENERAL}};
}

Pipeline::Pipeline(const Device& owner, std::span<const ShaderCode> shaders, std::span<const SpecConstant> constants)
    : device(owner), name(shaders.front().name), text(textOf(name, constants)) {
    std::vector<uint32_t> known;
    for (const ShaderCode& shader : shaders) reflect(shader, known);
    for (const SpecConstant& c : constants)
        if (std::find(known.begin(), known.end(), c.id) == known.end())
            throw Error(name + ": no shader has a specialization constant with the id " + std::to_string(c.id) +
                        " (shaders/shared/constants.h)");
    try { // a constructor that throws runs no destructor
        createLayout();
    } catch (...) {
        destroy();
        throw;
    }
}

Pipeline::~Pipeline() { destroy(); }

void Pipeline::destroy() {
    vkDestroyPipeline(device.handle(), handle, nullptr);
    vkDestroyPipelineLayout(device.handle(), layout, nullptr);
    vkDestroyDescriptorSetLayout(device.handle(), set_layout, nullptr);
}

void Pipeline::reflect(const ShaderCode& shader, std::vector<uint32_t>& constant_ids) {
    stages |= shader.stage;
    spvc_context context = nullptr;
    if (spvc_context_create(&context) != SPVC_SUCCESS) throw Error("SPIRV-Cross cannot start");
    struct Guard {
        spvc_context context;
        ~Guard() { spvc_context_destroy(context); }
    } guard{context};
    const auto need = [&](spvc_result result) {
        if (result != SPVC_SUCCESS)
            throw Error(std::string(shader.name) +
                        ": the SPIR-V cannot be read: " + spvc_context_get_last_error_string(context));
    };
    spvc_parsed_ir ir = nullptr;
    need(spvc_context_parse_spirv(context, shader.words.data(), shader.words.size(), &ir));
    spvc_compiler compiler = nullptr;
    need(spvc_context_create_compiler(context, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &compiler));
    spvc_set active = nullptr;
    need(spvc_compiler_get_active_interface_variables(compiler, &active));
    spvc_resources resources = nullptr;
    need(spvc_compiler_create_shader_resources_for_active_variables(compiler, &resources, active));

    constexpr std::pair<spvc_resource_type, VkDescriptorType> kKinds[] = {
        {SPVC_RESOURCE_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
        {SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER},
        {SPVC_RESOURCE_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE},
        {SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER},
    };
    const spvc_reflected_resource* list = nullptr;
    size_t count = 0;
    for (const auto& [kind, type] : kKinds) {
        need(spvc_resources_get_resource_list_for_type(resources, kind, &list, &count));
        for (size_t i = 0; i < count; ++i) {
            const uint32_t binding = spvc_compiler_get_decoration(compiler, list[i].id, SpvDecorationBinding);
            const auto known =
                std::find_if(expected.begin(), expected.end(), [&](const auto& e) { return e.binding == binding; });
            if (known == expected.end())
                expected.push_back({binding, type, list[i].name});
            else if (known->type != type)
                throw Error(std::string(shader.name) + ": binding " + std::to_string(binding) +
                            " is used as two kinds");
        }
    }
    need(spvc_resources_get_resource_list_for_type(resources, SPVC_RESOURCE_TYPE_PUSH_CONSTANT, &list, &count));
    for (size_t i = 0; i < count; ++i) {
        size_t bytes = 0;
        need(spvc_compiler_get_declared_struct_size(
            compiler, spvc_compiler_get_type_handle(compiler, list[i].base_type_id), &bytes));
        if (push_bytes && push_bytes != bytes)
            throw Error(std::string(shader.name) + ": stages disagree on the push constants");
        push_bytes = uint32_t(bytes);
    }
    const spvc_specialization_constant* constants = nullptr;
    need(spvc_compiler_get_specialization_constants(compiler, &constants, &count));
    for (size_t i = 0; i < count; ++i) constant_ids.push_back(constants[i].constant_id);
    if (expected.size() > kMaxBindings) throw Error(std::string(shader.name) + ": too many bindings");
}

void Pipeline::createLayout() {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const Expected& e : expected) bindings.push_back({e.binding, e.type, 1, stages, nullptr});
    VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set.bindingCount = uint32_t(bindings.size());
    set.pBindings = bindings.data();
    check(vkCreateDescriptorSetLayout(device.handle(), &set, nullptr, &set_layout), name.c_str());

    const VkPushConstantRange range{stages, 0, push_bytes};
    VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    info.setLayoutCount = 1;
    info.pSetLayouts = &set_layout;
    info.pushConstantRangeCount = push_bytes ? 1 : 0;
    info.pPushConstantRanges = &range;
    check(vkCreatePipelineLayout(device.handle(), &info, nullptr, &layout), name.c_str());
}

namespace {

void checkRange(const Pipeline& pipeline, const Resource& given, const Pipeline::Expected& e) {
    const VkPhysicalDeviceLimits& limits = pipeline.device.properties().limits;
    const VkDeviceSize most = e.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER   ? limits.maxStorageBufferRange
                              : e.type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER ? limits.maxUniformBufferRange
                                                                            : VK_WHOLE_SIZE;
    if (given.buffer.range > most)
        throw Error(pipeline.name + ": " + typeName(e.type) + " '" + e.name + "' of " +
                    std::to_string(given.buffer.range) + " bytes, the device allows " + std::to_string(most) +
                    "; use fewer particles or smaller pictures");
}

} // namespace

void Program::bind(Commands& commands, std::span<const Resource> resources, std::span<const std::byte> push) const {
    const Pipeline& p = *pipeline_;
    std::array<VkWriteDescriptorSet, kMaxBindings> writes;
    uint32_t count = 0;
    for (const Pipeline::Expected& e : p.expected) {
        const auto given =
            std::find_if(resources.begin(), resources.end(), [&](const auto& r) { return r.binding == e.binding; });
        if (given == resources.end() || given->type != e.type)
            throw Error(p.name + ": binding " + std::to_string(e.binding) + " needs a " + typeName(e.type) + " '" +
                        e.name + "'");
        checkRange(p, *given, e);
        VkWriteDescriptorSet& write = writes[count++];
        write = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstBinding = e.binding;
        write.descriptorCount = 1;
        write.descriptorType = e.type;
        write.pBufferInfo = &given->buffer;
        write.pImageInfo = &given->image;
    }
    if (push.size() != p.push_bytes)
        throw Error(p.name + ": push constants of " + std::to_string(push.size()) + " bytes, the shader has " +
                    std::to_string(p.push_bytes));
    const VkDescriptorSet set = commands.descriptorSet(p.set_layout);
    for (uint32_t i = 0; i < count; ++i) writes[i].dstSet = set;
    vkUpdateDescriptorSets(p.device.handle(), count, writes.data(), 0, nullptr);
    const VkCommandBuffer cmd = commands.handle();
    vkCmdBindPipeline(cmd, p.bind_point, p.handle);
    vkCmdBindDescriptorSets(cmd, p.bind_point, p.layout, 0, 1, &set, 0, nullptr);
    if (p.push_bytes) vkCmdPushConstants(cmd, p.layout, p.stages, 0, p.push_bytes, push.data());
}

namespace {

PipelineCache::Key keyOf(std::span<const ShaderCode> shaders, std::span<const SpecConstant> constants) {
    PipelineCache::Key key;
    for (const ShaderCode& shader : shaders) {
        key.push_back(uint64_t(shader.stage));
        key.push_back(reinterpret_cast<uintptr_t>(shader.words.data())); // of the program's constants: never freed
        key.push_back(shader.words.size());
    }
    for (const SpecConstant& c : constants) key.push_back(uint64_t{c.id} << 32 | c.value);
    return key;
}

// The pipeline that the device has for this key, or the one that `make` compiles.
template <class Make>
std::shared_ptr<const Pipeline> cached(const Device& device, PipelineCache::Key key, Make make) {
    std::shared_ptr<const Pipeline> pipeline = device.pipelines().find(key);
    if (pipeline) return pipeline;
    pipeline = make();
    device.pipelines().keep(std::move(key), pipeline);
    return pipeline;
}

std::shared_ptr<const Pipeline> compile(const Device& device, const ShaderCode& shader,
                                        std::span<const SpecConstant> constants) {
    const auto made = std::make_shared<Pipeline>(device, std::span(&shader, 1), constants);
    const ShaderModule module(device.handle(), shader, constants);
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage.stage = shader.stage;
    info.stage.module = module.handle;
    info.stage.pName = "main";
    info.layout = made->layout;
    check(vkCreateComputePipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &made->handle), shader.name);
    return made;
}

std::shared_ptr<const Pipeline> compile(const Device& device, std::span<const ShaderCode> shaders,
                                        const GraphicsInfo& what, std::span<const SpecConstant> constants) {
    const auto made = std::make_shared<Pipeline>(device, shaders, constants);
    made->bind_point = VK_PIPELINE_BIND_POINT_GRAPHICS;
    std::vector<std::unique_ptr<ShaderModule>> modules;
    std::vector<VkPipelineShaderStageCreateInfo> stages;
    for (const ShaderCode& shader : shaders) {
        modules.push_back(std::make_unique<ShaderModule>(device.handle(), shader, constants));
        VkPipelineShaderStageCreateInfo stage{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
        stage.stage = shader.stage;
        stage.module = modules.back()->handle;
        stage.pName = "main";
        stages.push_back(stage);
    }
    VkPipelineVertexInputStateCreateInfo vertices{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = what.topology;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.cullMode = VK_CULL_MODE_NONE;
    raster.lineWidth = 1;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineColorBlendAttachmentState target{};
    target.blendEnable = what.blend != Blend::replace;
    target.srcColorBlendFactor = VK_BLEND_FACTOR_ONE;
    target.dstColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
    target.colorBlendOp = what.blend == Blend::largest ? VK_BLEND_OP_MAX : VK_BLEND_OP_ADD;
    target.srcAlphaBlendFactor = VK_BLEND_FACTOR_ZERO;
    target.dstAlphaBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
    target.alphaBlendOp = target.colorBlendOp;
    target.colorWriteMask = 0xF;
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    const std::vector<VkPipelineColorBlendAttachmentState> targets(what.formats.size(), target);
    blend.attachmentCount = uint32_t(targets.size());
    blend.pAttachments = targets.data();
    const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = 2;
    dynamic.pDynamicStates = dynamic_states;
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = uint32_t(what.formats.size());
    rendering.pColorAttachmentFormats = what.formats.data();

    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    info.pNext = &rendering;
    info.stageCount = uint32_t(stages.size());
    info.pStages = stages.data();
    const bool mesh = (made->stages & VK_SHADER_STAGE_MESH_BIT_EXT) != 0;
    info.pVertexInputState = mesh ? nullptr : &vertices;
    info.pInputAssemblyState = mesh ? nullptr : &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = made->layout;
    check(vkCreateGraphicsPipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &made->handle),
          shaders.front().name);
    return made;
}

} // namespace

ComputeProgram::ComputeProgram(const Device& device, const ShaderCode& shader,
                               std::initializer_list<SpecConstant> constants)
    : Program(cached(device, keyOf({&shader, 1}, constants), [&] { return compile(device, shader, constants); })) {}

GraphicsProgram::GraphicsProgram(const Device& device, std::span<const ShaderCode> shaders, const GraphicsInfo& what,
                                 std::span<const SpecConstant> constants)
    : Program(cached(
          device,
          [&] {
              PipelineCache::Key key = keyOf(shaders, constants);
              key.push_back(uint64_t(what.topology) << 32 | uint64_t(what.blend));
              key.insert(key.end(), what.formats.begin(), what.formats.end());
              return key;
          }(),
          [&] { return compile(device, shaders, what, constants); })) {}

} // namespace brume::gpu
