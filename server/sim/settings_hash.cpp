#include "server/sim/settings_hash.h"

#include <cstring>
#include <type_traits>

#include "server/sim/state_hash.h"

namespace brume {
namespace {

// By their bits, as hashes are: -0 is another value than 0.
template <class T>
std::string_view bytesOf(const T& value) {
    if constexpr (std::is_same_v<T, std::string>)
        return value;
    else
        return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

} // namespace

uint64_t hashOf(std::span<const SceneSetting* const> settings, const SceneParts& parts, uint32_t element) {
    uint64_t sum = 0;
    for (const SceneSetting* setting : settings)
        std::visit(
            [&]<class T>(T* value) {
                if constexpr (std::is_trivially_copyable_v<T> || std::is_same_v<T, std::string>) {
                    const std::string_view bytes = bytesOf(*value);
                    if (bytes == bytesOf(*std::get<T*>(setting->member(defaultParts())))) return;
                    sum += hashOf(bytes, hashOf(setting->path, element));
                }
            },
            setting->member(parts));
    return sum;
}

} // namespace brume
