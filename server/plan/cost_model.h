// What a unit of each pass's work costs on a device: the constants of the plan's predictions. Measured by `brume-bench
// calibrate`.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace brume {

// One pass that is predicted, and the unit that its work is counted in.
struct CostInfo {
    const char* key;  // in files
    const char* pass; // as gpu::PassSample::name
    double built_in;  // ns per unit, measured on lavapipe (Mesa 25.0, 256 bits), two threads of an AMD EPYC
};

// Passes of no method, or of all that draw.
namespace costs {
inline constexpr CostInfo kUpload{"upload", "upload", 38};                         // particles
inline constexpr CostInfo kOpaqueShadow{"opaque_shadow", "opaque shadow", 2};      // texels x casters
inline constexpr CostInfo kShadowVolume{"shadow_volume", "shadow volume", 0.2};    // particles x cells they reach, and the cells
inline constexpr CostInfo kParticleLight{"particle_light", "particle light", 130}; // particles
inline constexpr CostInfo kOpaque{"opaque", "opaque", 7.3};                        // pixels x (1 + objects)
inline constexpr CostInfo kCompose{"compose", "compose", 11};                      // pixels, of a medium that was drawn
} // namespace costs

// All costs there are: those above, then those of every method. Their numbers are places in Work and CostModel.
std::span<const CostInfo* const> allCosts();
size_t numberOf(const CostInfo& cost);
inline constexpr size_t kMostCosts = 64;

struct CostModel {
    std::array<double, kMostCosts> ns{}; // per unit of work, by numberOf()
    std::string source;                  // where the constants are from, for people
    bool calibrated = false;             // True: measured on this device

    double operator[](const CostInfo& cost) const { return ns[numberOf(cost)]; }
};

CostModel builtInCosts();

// The user's cache folder: $XDG_CACHE_HOME/brume or ~/.cache/brume; the working folder where there is neither.
std::filesystem::path defaultCostFolder();

// FOLDER/costs-DEVICE-DRIVER.json, with everything but letters and digits as '-'.
std::filesystem::path costFile(const std::filesystem::path& folder, std::string_view device, std::string_view driver);

// The constants of the file; the built-in ones when there is none. When it cannot be read, is of another version or holds
// anything but positive numbers: the built-in ones, and one line in `complaint`.
CostModel loadCosts(const std::filesystem::path& file, std::string& complaint);

// Makes the folder. Throws std::runtime_error, one line.
void saveCosts(const std::filesystem::path& file, const CostModel& model, std::string_view device, std::string_view driver);

} // namespace brume
