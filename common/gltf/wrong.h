// What is wrong with a glTF file, without the file's name.
#pragma once

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace brume::gltf {

struct Wrong : std::runtime_error {
    using std::runtime_error::runtime_error;
};

template <class... Parts>
[[noreturn]] void fail(fmt::format_string<Parts...> format, Parts&&... parts) {
    throw Wrong(fmt::format(format, std::forward<Parts>(parts)...));
}

} // namespace brume::gltf
