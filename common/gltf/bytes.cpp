#include "common/gltf/bytes.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>

#include "common/gltf/told.h"
#include "common/gltf/wrong.h"
#include "common/plain_file.h"

namespace brume::gltf {
namespace {

constexpr size_t kLongestUri = 100; // bytes, in a message

int hexOf(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    const char lower = char(c | 0x20);
    return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

// %20 is a space; what is no such escape stays.
std::string unescaped(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (size_t i = 0; i < text.size(); ++i) {
        const int high = i + 2 < text.size() ? hexOf(text[i + 1]) : -1, low = high >= 0 ? hexOf(text[i + 2]) : -1;
        const bool escape = text[i] == '%' && low >= 0;
        out += escape ? char(high * 16 + low) : text[i];
        i += escape ? 2 : 0;
    }
    return out;
}

bool equalsWithoutCase(std::string_view a, std::string_view lower) {
    return std::ranges::equal(a, lower, [](char x, char y) { return (x >= 'A' && x <= 'Z' ? x + 32 : x) == y; });
}

constexpr std::array<int, 256> kSixBits = [] {
    std::array<int, 256> out{};
    out.fill(-1);
    const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < digits.size(); ++i) out[static_cast<unsigned char>(digits[i])] = int(i);
    return out;
}();

Bytes fromBase64(std::string_view text) {
    text = text.substr(0, text.find_last_not_of("= \t\n\r") + 1);
    Bytes out;
    out.reserve(text.size() * 3 / 4);
    uint32_t word = 0;
    int bits = 0;
    for (const char c : text) {
        if (c == ' ' || c == '\t' || c == '\n' || c == '\r') continue; // lines that somebody broke
        const int six = kSixBits[static_cast<unsigned char>(c)];
        if (six < 0) fail("a data URI holds what is no base64");
        word = word << 6 | uint32_t(six);
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        out.push_back(static_cast<unsigned char>(word >> bits));
    }
    return out;
}

// data:[type][;parameters][;base64],data (RFC 2397); without base64 the data is text with escapes.
Bytes ofDataUri(std::string_view uri) {
    const size_t comma = uri.find(',');
    if (comma == std::string_view::npos) fail("a data URI without a comma before its data");
    const std::string_view head = uri.substr(0, comma), data = uri.substr(comma + 1);
    const size_t last = head.rfind(';');
    const bool escapes = data.find('%') != std::string_view::npos;
    if (last != std::string_view::npos && equalsWithoutCase(head.substr(last + 1), "base64"))
        return escapes ? fromBase64(unescaped(data)) : fromBase64(data);
    const std::string text = unescaped(data);
    return {text.begin(), text.end()};
}

} // namespace

bool readBytes(const std::filesystem::path& file, size_t most, Bytes& out) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return false;
    const uint64_t size = std::filesystem::file_size(file, error);
    std::ifstream in = openPlain(file);
    if (error || !in || size > most) return false;
    out.resize(size);
    in.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(size));
    out.resize(static_cast<size_t>(in.gcount()));
    return true;
}

Bytes Sources::beside(std::string_view uri) {
    const std::string text = unescaped(uri);
    const std::filesystem::path inside = text;
    const bool climbs = std::ranges::find(inside, "..") != inside.end();
    const bool plain = std::ranges::none_of(text, [](unsigned char c) { return c < ' '; });
    std::error_code error;
    if (climbs || !plain || text.empty() || inside.is_absolute() ||
        !std::filesystem::is_regular_file(folder_ / inside, error))
        fail("uri \"{}\" is not found in the file's folder", shortened(std::string(uri), kLongestUri));
    Bytes out;
    if (!readBytes(folder_ / inside, left_, out))
        fail("uri \"{}\" cannot be read, or is more than {} MiB with others", shortened(std::string(uri), kLongestUri),
             kMostBytes >> 20);
    return out;
}

Bytes Sources::read(std::string_view uri) {
    const bool data = uri.size() >= 5 && equalsWithoutCase(uri.substr(0, 5), "data:");
    Bytes out = data ? ofDataUri(uri.substr(5)) : beside(uri);
    if (out.size() > left_) fail("data of more than {} MiB with others", kMostBytes >> 20);
    left_ -= out.size();
    return out;
}

} // namespace brume::gltf
