// Writes results of sweeps as Markdown and plots.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

namespace brume::bench {

// Writes `folder`/NAME.md and its plots NAME-*.svg. Throws std::runtime_error if it cannot, or if `results` are not
// those of a sweep.
void writeReport(const nlohmann::json& results, const std::filesystem::path& folder, const std::string& name);

// A table of the measurements that are in both: time of `now` / time of `before`, and both errors.
std::string compareResults(const nlohmann::json& before, const nlohmann::json& now);

} // namespace brume::bench
