// The file that a sweep's results are kept in.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace brume::bench {

// Reads such a file. Throws std::runtime_error, one line, if it is no JSON.
nlohmann::json readResults(const std::filesystem::path& file);

// The results `now`, and of `before` those series whose names `now` lacks, in the order of `before`.
nlohmann::json merged(const nlohmann::json& before, const nlohmann::json& now);

// JSON with a row of measurements a line, and five digits of a number: fewer than two runs have alike, and files that
// a person can compare.
std::string textOf(const nlohmann::json& results);

} // namespace brume::bench
