// Variants: the programs of the same shaders, one for each set of values of their specialization constants.
#pragma once

#include <array>
#include <initializer_list>
#include <list>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <boost/container/static_vector.hpp>

#include "server/gpu/program.h"

namespace brume::gpu {

inline constexpr size_t kMostConstants = 32; // of the shaders of one program

// Values for whichever shader has constants of these ids.
using Constants = boost::container::static_vector<SpecConstant, kMostConstants>;

class Variants {
public:
    // Of a compute shader. `code`: SPIR-V that is never freed.
    Variants(const Device& device, std::span<const uint32_t> code, const char* name)
        : Variants(device, {{VK_SHADER_STAGE_COMPUTE_BIT, code, name}}, std::optional<GraphicsInfo>()) {}
    // Of shaders that draw.
    Variants(const Device& device, std::vector<ShaderCode> shaders, const GraphicsInfo& info)
        : Variants(device, std::move(shaders), std::optional(info)) {}

    // The program with the values in `own`, and with those of `offered` that the shaders have and `own` lacks. It is
    // compiled when it is first asked for, and lives as long as this. Throws Error if the shaders lack one of `own`.
    const Program& with(std::span<const SpecConstant> offered, std::span<const SpecConstant> own);
    const Program& with(std::span<const SpecConstant> offered, std::initializer_list<SpecConstant> own = {}) {
        return with(offered, std::span(own.begin(), own.size()));
    }
    const Program& with(std::initializer_list<SpecConstant> own = {}) { return with(Constants(), own); }

private:
    Variants(const Device& device, std::vector<ShaderCode> shaders, std::optional<GraphicsInfo> info);

    // Values in the order of ids_, and which of them are given, bit by bit.
    struct Key {
        std::array<uint32_t, kMostConstants> values{};
        uint32_t given = 0;
        bool operator==(const Key&) const = default;
        void set(size_t at, uint32_t value) { values[at] = value, given |= 1u << at; }
    };
    struct Made {
        Key key;
        Program program;
    };

    const Device* device_;
    std::vector<ShaderCode> shaders_;
    std::optional<GraphicsInfo> info_; // nothing: the shader is a compute shader
    std::vector<uint32_t> ids_;        // of the shaders' constants
    std::list<Made> made_;
};

} // namespace brume::gpu
