// From the results of sweeps to Markdown and plots.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

namespace brume::bench {

// Writes `folder`/NAME.md and its NAME-*.svg. Throws std::runtime_error when it cannot, or `results` is not a sweep's.
void writeReport(const nlohmann::json& results, const std::filesystem::path& folder, const std::string& name);

// A table of what is in both: times of `now` over those of `before`, errors beside each other.
std::string compareResults(const nlohmann::json& before, const nlohmann::json& now);

} // namespace brume::bench
