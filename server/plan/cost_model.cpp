#include "server/plan/cost_model.h"

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace brume {
namespace {

constexpr int kVersion = 3; // of the file; grows when a pass counts its work in another unit

constexpr CostInfo kInfo[kCosts] = {
    {"upload", "upload", nullptr, 38},
    {"opaque_shadow", "opaque shadow", nullptr, 2},
    {"shadow_volume", "shadow volume", nullptr, 0.2},
    {"particle_light", "particle light", nullptr, 130},
    {"opaque", "opaque", nullptr, 7.3},
    {"compose", "compose", nullptr, 11},
    {"order", "cull, sort", nullptr, 1300},
    {"sphere", "medium", "sphere", 20},
    {"isv", "medium", "isv", 22},
    {"tile_bin", "bin", "tiles", 870},
    {"tiles", "medium", "tiles", 1.1},
    {"slab_bin", "bin", "slabs", 10},
    {"slabs", "slabs", "slabs", 0.14},
    {"slab_light", "slab light", "slabs", 8.9},
    {"grid_bin", "grid bins", "grid", 14},
    {"grid", "grid", "grid", 0.15},
    {"grid_rays", "grid rays", "grid", 12},
    {"compose_field", "compose", nullptr, 11},
    {"shade", "shade", nullptr, 170},
    {"present", "present", nullptr, 3.4},
};

} // namespace

const CostInfo& info(Cost cost) { return kInfo[size_t(cost)]; }

CostModel builtInCosts() {
    CostModel model;
    for (size_t i = 0; i < kCosts; ++i) model.ns[i] = kInfo[i].built_in;
    model.source = "built in, estimated on lavapipe; brume-bench calibrate measures this device";
    return model;
}

std::filesystem::path defaultCostFolder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return std::filesystem::path(cache) / "brume";
    if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache" / "brume";
    return ".";
}

std::filesystem::path costFile(const std::filesystem::path& folder, std::string_view device, std::string_view driver) {
    std::string name = "costs-" + std::string(device) + "-" + std::string(driver);
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '-';
    return folder / (name + ".json");
}

CostModel loadCosts(const std::filesystem::path& file, std::string& complaint) {
    CostModel model = builtInCosts();
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return model;
    const auto refused = [&](const std::string& why) {
        complaint = file.string() + ": " + why + "; the built-in costs hold (brume-bench calibrate writes it anew)";
        return builtInCosts();
    };
    std::ifstream in(file);
    const nlohmann::json parsed = nlohmann::json::parse(in, nullptr, false);
    if (!parsed.is_object()) return refused("cannot be read as JSON");
    if (!parsed.contains("version") || parsed["version"] != kVersion) return refused("is of another version");
    for (size_t i = 0; i < kCosts; ++i) {
        const auto ns = parsed.find(kInfo[i].key);
        if (ns == parsed.end() || !ns->is_number() || !(ns->get<double>() > 0) || !std::isfinite(ns->get<double>()))
            return refused(std::string(kInfo[i].key) + " is no positive number");
        model.ns[i] = ns->get<double>();
    }
    model.source = "calibrated, " + file.string();
    model.calibrated = true;
    return model;
}

void saveCosts(const std::filesystem::path& file, const CostModel& model, std::string_view device, std::string_view driver) {
    nlohmann::ordered_json out{{"version", kVersion}, {"device", device}, {"driver", driver}, {"unit", "ns per unit of work"}};
    for (size_t i = 0; i < kCosts; ++i) out[kInfo[i].key] = model.ns[i];
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    std::ofstream stream(file);
    stream << out.dump(1) << '\n';
    if (!stream.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

} // namespace brume
