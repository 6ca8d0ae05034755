// wholeNumber(): numbers of JSON that comes from outside.
#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace brume {

// nlohmann's own get<uint64_t>() takes 1e30, -1 and 1.5, too; the first is undefined behaviour. Throws
// std::runtime_error if it is no whole number from 0 to T's largest.
template <std::unsigned_integral T = uint64_t>
T wholeNumber(const nlohmann::json& in) {
    if (!in.is_number_unsigned() || in.get<uint64_t>() > std::numeric_limits<T>::max())
        throw std::runtime_error("no whole number, or too large a one");
    return T(in.get<uint64_t>());
}

} // namespace brume
