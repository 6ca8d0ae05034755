#include "server/plan/cost_model.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/plain_file.h"
#include "server/effects/effect_plan.h"
#include "server/methods/plans.h"

namespace brume {
namespace {

// Version of the file. It grows when a pass is new, counts its work in another unit, or is timed otherwise.
constexpr int kVersion = 12;

constexpr const CostInfo* kCommon[] = {&costs::kUpload, &costs::kOpaque, &costs::kCompose};

std::vector<const CostInfo*> collected() {
    std::vector<const CostInfo*> all(std::begin(kCommon), std::end(kCommon));
    const auto add = [&](std::span<const CostInfo* const> more) {
        for (const CostInfo* cost : more)
            if (std::find(all.begin(), all.end(), cost) == all.end()) all.push_back(cost);
    };
    for (const EffectPlan* plan : effectPlans()) add(plan->costs());
    for (const MethodPlan* plan : methodPlans()) add(plan->costs());
    if (all.size() > kMostCosts) throw std::logic_error("kMostCosts is below the number of passes");
    return all;
}

} // namespace

std::span<const CostInfo* const> allCosts() {
    static const std::vector<const CostInfo*> kAll = collected();
    return kAll;
}

size_t numberOf(const CostInfo& cost) {
    const std::span<const CostInfo* const> all = allCosts();
    const auto found = std::find(all.begin(), all.end(), &cost);
    if (found == all.end()) throw std::logic_error(std::string(cost.key) + " is not among its method's costs()");
    return size_t(found - all.begin());
}

CostModel builtInCosts() {
    CostModel model;
    for (const CostInfo* cost : allCosts()) model.ns[numberOf(*cost)] = cost->built_in;
    model.source = "built in, estimated on lavapipe; a running server corrects them";
    return model;
}

std::filesystem::path userCacheFolder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
        return std::filesystem::path(cache) / "brume";
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
    std::ifstream in = openPlain(file);
    const nlohmann::json parsed = nlohmann::json::parse(in, nullptr, false);
    if (!parsed.is_object()) return refused("cannot be read as JSON");
    const auto version = parsed.find("version");
    if (version == parsed.end() || !version->is_number_integer()) return refused("has no version");
    if (*version < kVersion) return model; // of an older server: it is learnt anew
    if (*version > kVersion) return refused("is of a newer version");
    for (const CostInfo* cost : allCosts()) {
        const auto ns = parsed.find(cost->key);
        if (ns == parsed.end() || !ns->is_number() || !(ns->get<double>() > 0) || !std::isfinite(ns->get<double>()))
            return refused(std::string(cost->key) + " is no positive number");
        model.ns[numberOf(*cost)] = ns->get<double>();
    }
    model.learnt = parsed.value("learnt", false);
    model.source = (model.learnt ? "learnt while running, " : "calibrated, ") + file.string();
    model.calibrated = true;
    return model;
}

namespace {

// ln of what the costs of a device are beside the built-in ones.
double usualFactor(const CostModel& costs) {
    if (costs.on_cpu) return 0;
    double sum = 0;
    for (const CostInfo* cost : allCosts()) sum += std::log(costs[*cost] / cost->built_in);
    return sum / double(allCosts().size());
}

} // namespace

CostModel halfForgotten(const CostModel& learnt) {
    CostModel out = learnt;
    const double usual = std::exp(usualFactor(learnt));
    for (const CostInfo* cost : allCosts()) out.ns[numberOf(*cost)] = std::sqrt(learnt[*cost] * cost->built_in * usual);
    return out;
}

std::string unusualCosts(const CostModel& learnt) {
    constexpr double kUsual = 4;
    const double usual = std::exp(usualFactor(learnt));
    std::string line;
    for (const CostInfo* cost : allCosts()) {
        const double factor = learnt[*cost] / (cost->built_in * usual);
        if (factor > kUsual || factor < 1 / kUsual)
            line += fmt::format("{}{} {:.2g} times", line.empty() ? "" : ", ", cost->key, factor);
    }
    return line;
}

void saveCosts(const std::filesystem::path& file, const CostModel& model, std::string_view device,
               std::string_view driver) {
    nlohmann::ordered_json out{
        {"version", kVersion}, {"device", device}, {"driver", driver}, {"unit", "ns per unit of work"}};
    if (model.learnt) out["learnt"] = true;
    for (const CostInfo* cost : allCosts()) out[cost->key] = model[*cost];
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    const std::filesystem::path part = file.string() + ".part"; // whole or not at all
    std::ofstream stream(part);
    stream << out.dump(1) << '\n';
    if (!stream.flush()) throw std::runtime_error(file.string() + ": cannot be written");
    stream.close();
    std::filesystem::rename(part, file, error);
    if (error) throw std::runtime_error(file.string() + ": cannot be written: " + error.message());
}

} // namespace brume
