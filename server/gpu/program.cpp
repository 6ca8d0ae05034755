#include "server/gpu/program.h"

#include <algorithm>
#include <iterator>
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

Pipeline::Pipeline(const Device& owner, std::span<const ShaderCode> shaders, std::span<const SpecConstant> constants)
    : device(owner), name(shaders.front().name), text(textOf(name, constants)) {
    std::vector<uint32_t> ids;
    for (const ShaderCode& shader : shaders) {
        code.emplace_back(shader.words.begin(), shader.words.end());
        reflect(shader, code.back());
        std::ranges::copy(constantIds(shader.words), std::back_inserter(ids));
    }
    for (const SpecConstant& c : constants)
        if (std::ranges::find(ids, c.id) == ids.end()) throw unknownConstant(name, c.id);
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

void Pipeline::reflect(const ShaderCode& shader, std::vector<uint32_t>& words) {
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
            const auto known = std::ranges::find_if(
                expected, [&, of = type](const auto& e) { return e.type == of && e.name == list[i].name; });
            uint32_t at = 0;
            if (!spvc_compiler_get_binary_offset_for_decoration(compiler, list[i].id, SpvDecorationBinding, &at))
                throw Error(std::string(shader.name) + ": '" + list[i].name + "' has no binding to be set");
            words[at] = uint32_t(known - expected.begin());
            if (known == expected.end()) expected.push_back({type, list[i].name});
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
    if (expected.size() > kMaxBindings) throw Error(std::string(shader.name) + ": too many bindings");
}

void Pipeline::createLayout() {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const Expected& e : expected) bindings.push_back({uint32_t(bindings.size()), e.type, 1, stages, nullptr});
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

void Program::bind(Commands& commands, const Resources& shared, std::span<const Resource> own,
                   std::span<const std::byte> push) const {
    const Pipeline& p = *pipeline_;
    std::array<VkWriteDescriptorSet, kMaxBindings> writes;
    uint32_t count = 0;
    for (const Pipeline::Expected& e : p.expected) {
        const auto mine =
            std::find_if(own.begin(), own.end(), [&](const auto& r) { return r.type == e.type && r.name == e.name; });
        const Resource* const given = mine != own.end() ? &*mine : shared.find(e.name, e.type);
        if (!given) throw Error(p.name + ": nobody gives it the " + typeName(e.type) + " '" + e.name + "'");
        checkRange(p, *given, e);
        VkWriteDescriptorSet& write = writes[count++];
        write = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstBinding = count - 1;
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
    const ShaderModule module(device.handle(), {shader.stage, made->code.front(), shader.name}, constants);
    made->code = {};
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
    for (size_t i = 0; i < shaders.size(); ++i) {
        const ShaderCode bound{shaders[i].stage, made->code[i], shaders[i].name};
        modules.push_back(std::make_unique<ShaderModule>(device.handle(), bound, constants));
        VkPipelineShaderStageCreateInfo stage{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
        stage.stage = shaders[i].stage;
        stage.module = modules.back()->handle;
        stage.pName = "main";
        stages.push_back(stage);
    }
    made->code = {};
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

ComputeProgram::ComputeProgram(const Device& device, const ShaderCode& shader, std::span<const SpecConstant> constants)
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
