// StateBytes: a state as bytes, little-endian, for another process of the same version. One function both writes and
// reads a state, so that the two cannot differ.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace brume {

static_assert(std::endian::native == std::endian::little, "states are kept little-endian");

// A state that cannot be read. The text is one line.
struct StateError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class StateBytes {
public:
    // Appends to `out`.
    explicit StateBytes(std::vector<std::byte>& out) : out_(&out) {}
    // Reads `in`. Each function below then throws StateError where too few bytes are left.
    explicit StateBytes(std::span<const std::byte> in) : in_(in) {}

    // True: values get what the bytes say; false: they are written.
    bool reads() const { return out_ == nullptr; }
    // Bytes that are not read yet.
    std::span<const std::byte> left() const { return in_; }

    template <class T>
    void values(std::span<T> all) {
        static_assert(std::is_trivially_copyable_v<T>);
        const size_t size = all.size_bytes();
        if (size == 0) return;
        if (reads()) {
            if (in_.size() < size) throw StateError("a state that is cut");
            std::memcpy(all.data(), in_.data(), size);
            in_ = in_.subspan(size);
        } else {
            const auto* from = reinterpret_cast<const std::byte*>(all.data());
            out_->insert(out_->end(), from, from + size);
        }
    }
    template <class T>
    void value(T& one) {
        values(std::span(&one, 1));
    }
    // A byte of 0 or 1, or else StateError.
    void value(bool& one) {
        uint8_t byte = one;
        values(std::span(&byte, 1));
        if (byte > 1) throw StateError("a state with a flag that is neither set nor clear");
        one = byte == 1;
    }
    // At most `most` bytes, or else StateError.
    void value(std::string& text, size_t most = 1 << 20) {
        text.resize(size(text.size(), most));
        values(std::span(text));
    }
    // The size of a list, which is `now` when it is written.
    size_t size(size_t now, size_t most) {
        auto count = static_cast<uint64_t>(now);
        value(count);
        if (count > most) throw StateError("a state with a list that is too long");
        return static_cast<size_t>(count);
    }

private:
    std::vector<std::byte>* out_ = nullptr; // null: it reads
    std::span<const std::byte> in_;
};

} // namespace brume
