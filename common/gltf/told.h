// Told: lines on what a reader left out of a file.
#pragma once

#include <string>
#include <vector>

namespace brume::gltf {

inline constexpr size_t kMostTold = 16;     // lines
inline constexpr size_t kLongestTold = 200; // bytes of a line

class Told {
public:
    // `text` may hold what stands in the file. The same text again adds to its count, which is shown with the unit:
    // "lines and points are left out (3 primitives)". Without a unit it is shown alone.
    void add(std::string text, size_t count = 1, const char* unit = "");

    // One line each, without control characters.
    std::vector<std::string> lines() const;

private:
    struct Note {
        std::string text;
        size_t count;
        std::string unit;
    };
    std::vector<Note> notes_;
    bool more_ = false; // True: there were more than kMostTold different ones
};

// At most `most` bytes of a text that stands in the file, as one line; no character is cut in two.
std::string shortened(std::string text, size_t most);

} // namespace brume::gltf
