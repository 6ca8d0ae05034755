// Numbers as reports show them.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace brume::load {

// Three digits that count; "-" for NaN, which stands for what there is not.
std::string digits(double value);
// To the fourth decimal, one more than a person reads. NaN becomes null.
nlohmann::json rounded(double value);

} // namespace brume::load
