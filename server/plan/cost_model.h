// Cost model: nanoseconds per unit of work for every pass, the constants of the plan's predictions. A running
// server corrects them (cost_learning.h); `brume-bench calibrate` measures them all on a device.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace brume {

// One pass that the plan predicts. Its comment in the list names the unit that its work is counted in.
struct CostInfo {
    const char* key;  // name in cost files
    const char* pass; // gpu::PassSample::name of the pass
    double built_in;  // ns per unit, measured on lavapipe (Mesa 25.0, 256 bits), two threads of an AMD EPYC
};

// Passes that belong to no method and no effect. `compose` is a cost of those methods that draw into a picture.
namespace costs {
inline constexpr CostInfo kUpload{"upload", "upload", 38};    // particles
inline constexpr CostInfo kOpaque{"opaque", "opaque", 7.3};   // pixels x (1 + objects)
inline constexpr CostInfo kCompose{"compose", "compose", 11}; // pixels
} // namespace costs

// All costs: those above, then those of every effect and method. numberOf() is the index in this list, in Work and in
// CostModel.
std::span<const CostInfo* const> allCosts();
size_t numberOf(const CostInfo& cost);
inline constexpr size_t kMostCosts = 64;

struct CostModel {
    std::array<double, kMostCosts> ns{}; // per unit of work; index: numberOf()
    std::string source;                  // origin of the constants, for people
    bool calibrated = false;             // True: measured on this device
    bool learnt = false;                 // True: by a running server, not by brume-bench calibrate
    bool on_cpu = true;                  // True: the device is a CPU

    double operator[](const CostInfo& cost) const { return ns[numberOf(cost)]; }
};

CostModel builtInCosts();

// The user's cache folder: $XDG_CACHE_HOME/brume or ~/.cache/brume; the working folder if neither variable is set.
std::filesystem::path userCacheFolder();

// FOLDER/costs-DEVICE-DRIVER.json, with everything but letters and digits as '-'.
std::filesystem::path costFile(const std::filesystem::path& folder, std::string_view device, std::string_view driver);

// Reads the constants of a file. Returns the built-in ones if there is no file, or one of an older version. Returns
// them with one line in `complaint` if the file cannot be read, is newer, or holds anything but positive numbers.
CostModel loadCosts(const std::filesystem::path& file, std::string& complaint);

// Half of what was learnt, as factors on the built-in costs: what was learnt wrongly goes away by itself. On a GPU,
// which is faster in all, half of what differs from the mean factor.
CostModel halfForgotten(const CostModel& learnt);

// The costs that were learnt to be more than four times as dear or as cheap as built in, on a GPU than the mean factor
// makes them: "slab_light 5.2 times, sort 0.2 times". Empty where there are none.
std::string unusualCosts(const CostModel& learnt);

// Writes the file and makes its folder. Throws std::runtime_error, one line.
void saveCosts(const std::filesystem::path& file, const CostModel& model, std::string_view device,
               std::string_view driver);

} // namespace brume
