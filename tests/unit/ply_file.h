// PLY files that tests write.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>

namespace brume::test {

inline const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
// Four points in [0, 0, 0] to [1, 2, 3].
inline const std::string kFour = "0 0 0\n1 0 0\n0 2 0\n0 0 3\n";

template <class T>
std::string raw(T value) {
    std::string out(sizeof(T), '\0');
    std::memcpy(out.data(), &value, sizeof(T));
    return out;
}
template <class T>
std::string swapped(T value) {
    std::string out = raw(value);
    std::reverse(out.begin(), out.end());
    return out;
}

// An ASCII file of points, a line each. `properties`: those besides x, y, z.
inline std::string asciiPly(const std::string& properties, const std::string& points) {
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(std::count(points.begin(), points.end(), '\n')) +
           "\n" + kXyz + properties + "end_header\n" + points;
}
// The four points, each with those values behind its place.
inline std::string fourWith(const std::string& properties, const std::string& values) {
    std::string points;
    for (const char* place : {"0 0 0 ", "1 0 0 ", "0 2 0 ", "0 0 3 "}) points += place + values + "\n";
    return asciiPly(properties, points);
}

} // namespace brume::test
