#include "client/load/numbers.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace brume::load {

std::string digits(double value) {
    if (!std::isfinite(value)) return "-";
    const double size = std::abs(value);
    return fmt::format("{:.{}f}", value, size >= 100 ? 0 : size >= 10 ? 1 : 2);
}

nlohmann::json rounded(double value) {
    return std::isfinite(value) ? nlohmann::json(std::round(value * 1e4) / 1e4) : nlohmann::json(nullptr);
}

} // namespace brume::load
