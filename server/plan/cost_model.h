// What a unit of each pass's work costs on a device: the constants of the plan's predictions. Measured by `brume-bench
// calibrate`.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

namespace brume {

// The passes that are predicted, and the unit that each one's work is counted in.
enum class Cost : size_t {
    upload,         // particles
    opaque_shadow,  // texels x casters
    shadow_volume,  // particles x the cells that they reach, and the cells
    particle_light, // particles
    opaque,         // pixels x (1 + objects)
    compose,        // pixels, of a medium that was drawn
    order,          // particles + 2000: cull and sort
    sphere,         // fragments
    isv,            // fragments x (1 + steps)
    tile_bin,       // particles
    tiles,          // fragments
    slab_bin,       // particles x lines of tiles and sheets
    slabs,          // particles x the samples of the tiles and sheets that they reach
    slab_light,     // rays x slabs
    grid_bin,       // particles x lines of bricks
    grid,           // particles x the nodes of the bricks that they reach, and half the nodes
    grid_rays,      // rays x slabs x (1, 5 where sampling is cubic; with several albedos 4 times that)
    compose_field,  // pixels of a medium on a grid of rays x (1, 2 more with objects, 2 more for each caster), where all are
                    // shaded
    shade,          // shaded pixels, where not all are
    present,        // pixels, then
    count
};
inline constexpr size_t kCosts = size_t(Cost::count);

struct CostInfo {
    const char* key;    // in files
    const char* pass;   // as gpu::PassSample::name
    const char* method; // whose pass it is, null: of several
    double built_in;    // ns per unit
};
const CostInfo& info(Cost cost);

struct CostModel {
    std::array<double, kCosts> ns{}; // per unit of work
    std::string source;              // where the constants are from, for people
    bool calibrated = false;

    double operator[](Cost cost) const { return ns[size_t(cost)]; }
};

// Measured on lavapipe (Mesa 25.0, 256 bits), two threads of an AMD EPYC.
CostModel builtInCosts();

// The user's cache folder: $XDG_CACHE_HOME/brume or ~/.cache/brume; here where there is neither.
std::filesystem::path defaultCostFolder();

// FOLDER/costs-DEVICE-DRIVER.json, with everything but letters and digits as '-'.
std::filesystem::path costFile(const std::filesystem::path& folder, std::string_view device, std::string_view driver);

// The constants of the file; the built-in ones when there is none. When it cannot be read, is of another version or holds
// anything but positive numbers: the built-in ones, and one line in `complaint`.
CostModel loadCosts(const std::filesystem::path& file, std::string& complaint);

// Makes the folder. Throws std::runtime_error, one line.
void saveCosts(const std::filesystem::path& file, const CostModel& model, std::string_view device, std::string_view driver);

} // namespace brume
