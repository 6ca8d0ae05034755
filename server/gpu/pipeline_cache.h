// Pipelines by what they were compiled from. Some that no program uses any more are kept, since a CPU driver takes
// up to seconds to compile one.
#pragma once

#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "server/gpu/program.h"

namespace brume::gpu {

// A pipeline with its layout, and the resources that its shaders read.
struct Pipeline {
    struct Expected { // a resource; its binding is its index in `expected`
        VkDescriptorType type;
        std::string name;
    };

    // Reads the SPIR-V and makes the layouts. Throws Error if the id of one of `constants` is in none of the shaders.
    Pipeline(const Device& device, std::span<const ShaderCode> shaders, std::span<const SpecConstant> constants);
    ~Pipeline();
    Pipeline(const Pipeline&) = delete;
    Pipeline& operator=(const Pipeline&) = delete;

    const Device& device;
    const std::string name, text; // of its first shader; the same with its constants' values
    VkPipelineBindPoint bind_point = VK_PIPELINE_BIND_POINT_COMPUTE;
    VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline handle = VK_NULL_HANDLE;
    VkShaderStageFlags stages = 0;
    uint32_t push_bytes = 0;
    std::vector<Expected> expected;
    std::vector<std::vector<uint32_t>> code; // words of each shader, with those bindings; empty once compiled

private:
    // Adds what the shader reads, and writes the bindings of that into its words.
    void reflect(const ShaderCode& shader, std::vector<uint32_t>& words);
    void createLayout();
    void destroy();
};

// Thread-safe.
class PipelineCache {
public:
    static constexpr size_t kMostUnused = 96; // pipelines that no program uses; some ways' to render
    using Key = std::vector<uint64_t>;

    // The pipeline of this key, or null.
    std::shared_ptr<const Pipeline> find(const Key& key);
    // Keeps it. Of those that no program uses, the kMostUnused that were asked for last stay.
    void keep(Key key, std::shared_ptr<const Pipeline> pipeline);
    size_t size() const;

private:
    struct Kept {
        Key key;
        std::shared_ptr<const Pipeline> pipeline;
    };
    mutable std::mutex mutex_;
    friend class PipelineListener;
    std::list<std::function<void(const std::string&)>> listeners_;
    std::list<Kept> kept_; // the one that was asked for last is first
};

// Is told of every pipeline that is compiled while it lives, by Pipeline::text, in the thread that compiled it. Equal
// pipelines have equal texts in all processes. `made` must not call the cache.
class PipelineListener {
public:
    PipelineListener(PipelineCache& pipelines, std::function<void(const std::string&)> made);
    ~PipelineListener();
    PipelineListener(const PipelineListener&) = delete;
    PipelineListener& operator=(const PipelineListener&) = delete;

private:
    PipelineCache& pipelines_;
    std::list<std::function<void(const std::string&)>>::iterator place_;
};

} // namespace brume::gpu
