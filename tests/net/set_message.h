// The command Set with one change, for tests.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "protocol/message.h"

namespace brume::test {

// Each returns what builds the command: for wire::pack, or Session::sendCommand<wire::Set>.
inline auto set(std::string path, double number) {
    return [path = std::move(path), number](flatbuffers::FlatBufferBuilder& b) {
        const std::vector changes{wire::CreateChangeDirect(b, path.c_str(), number)};
        return wire::CreateSetDirect(b, &changes);
    };
}
inline auto set(std::string path, wire::Vec3 vector) {
    return [path = std::move(path), vector](flatbuffers::FlatBufferBuilder& b) {
        const std::vector changes{wire::CreateChangeDirect(b, path.c_str(), {}, &vector)};
        return wire::CreateSetDirect(b, &changes);
    };
}
inline auto set(std::string path, const char* text) {
    return [path = std::move(path), text](flatbuffers::FlatBufferBuilder& b) {
        const std::vector changes{wire::CreateChangeDirect(b, path.c_str(), {}, nullptr, text)};
        return wire::CreateSetDirect(b, &changes);
    };
}

} // namespace brume::test
