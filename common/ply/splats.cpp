#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "common/elementary.h"
#include "common/ply/points.h"

namespace brume::ply {
namespace {

constexpr double kHarmonic = 0.28209479177387814; // sqrt(1 / 4 pi): the spherical harmonic of order 0
constexpr char kSplatNote[] =
    "Gaussian splatting: splats are {}; their colours hold the light of the place they were taken at, and are shown as "
    "albedo{}";
constexpr char kAsBalls[] = "balls of the same volume (medium.model = \"ellipsoids\" keeps their axes)",
               kAsEllipsoids[] = "ellipsoids, as opaque as the file says where they are broadest";
constexpr size_t kOfChunk = 256; // splats

// A splat's numbers, those of 3D Gaussian splatting: colours are factors of kHarmonic, sizes logarithms of m, opacities
// logits.
// Rotations are quaternions, the real part first.
enum Number : size_t {
    kPlaceX,
    kPlaceY,
    kPlaceZ,
    kDc0,
    kDc1,
    kDc2,
    kLogit,
    kLog0,
    kLog1,
    kLog2,
    kRot0,
    kRot1,
    kRot2,
    kRot3,
    kNumbers
};
constexpr std::array<std::string_view, kNumbers> kNames{"x",      "y",       "z",       "f_dc_0",  "f_dc_1",
                                                        "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                                                        "rot_0",  "rot_1",   "rot_2",   "rot_3"};
using Splat = std::array<double, kNumbers>;

// The axes' directions, times each deviation over the largest. Without a rotation they are x, y and z.
void addAxes(const Splat& splat, Points& out) {
    const double squared = splat[kRot0] * splat[kRot0] + splat[kRot1] * splat[kRot1] + splat[kRot2] * splat[kRot2] +
                           splat[kRot3] * splat[kRot3];
    const double inverse = 1 / std::sqrt(squared);
    const bool turned = std::isfinite(inverse) && squared > 0;
    const double w = turned ? splat[kRot0] * inverse : 1, x = turned ? splat[kRot1] * inverse : 0,
                 y = turned ? splat[kRot2] * inverse : 0, z = turned ? splat[kRot3] * inverse : 0;
    const double directions[3][3]{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                                  {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                                  {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
    const double largest = std::max({splat[kLog0], splat[kLog1], splat[kLog2]});
    for (size_t axis = 0; axis < 3; ++axis) {
        const double length = exponential(std::max(splat[kLog0 + axis] - largest, -50.0));
        for (size_t i = 0; i < 3; ++i) out.columns[kAxisAX + 3 * axis + i].push_back(length * directions[axis][i]);
    }
}

void add(const Splat& splat, size_t row, bool axes, Points& out) {
    for (size_t axis = 0; axis < 3; ++axis) {
        out.columns[kX + axis].push_back(splat[kPlaceX + axis]);
        out.columns[kRed + axis].push_back(std::clamp(0.5 + kHarmonic * splat[kDc0 + axis], 0.0, 1.0));
    }
    const double ball = (splat[kLog0] + splat[kLog1] + splat[kLog2]) / 3;
    out.columns[kDeviation].push_back(exponential(axes ? std::max({splat[kLog0], splat[kLog1], splat[kLog2]}) : ball));
    if (axes) addAxes(splat, out);
    out.columns[kOpacity].push_back(1 / (1 + exponential(-splat[kLogit])));
    out.rows.push_back(uint32_t(row));
}

// Values of a row by their properties' numbers. A list's last one stands for it.
void readRow(Reader& in, const Element& element, uint64_t row, std::vector<double>& out) {
    out.assign(element.properties.size(), 0);
    in.beginRow(element, row);
    for (size_t p = 0; p < element.properties.size(); ++p) {
        const Property& property = element.properties[p];
        for (uint64_t n = property.list ? in.length(property) : 1; n > 0; --n) out[p] = in.value(property);
    }
    in.endRow();
}

// Extremes of the numbers of 256 splats.
struct Chunk {
    Splat lo{}, hi{};
};
constexpr std::array<std::string_view, 9> kExtremes{"x",       "y", "z", "scale_x", "scale_y",
                                                    "scale_z", "r", "g", "b"}; // min_x, max_x ...
constexpr std::array<Number, 9> kExtremeOf{kPlaceX, kPlaceY, kPlaceZ, kLog0, kLog1, kLog2, kDc0, kDc1, kDc2};

std::vector<Chunk> readChunks(Reader& in, const Element& element) {
    std::vector<Chunk> chunks;
    std::vector<double> values;
    for (uint64_t row = 0; row < element.count; ++row) {
        readRow(in, element, row, values);
        Chunk& chunk = chunks.emplace_back();
        for (size_t i = 0; i < kExtremes.size(); ++i) {
            const size_t lo = element.find(fmt::format("min_{}", kExtremes[i])),
                         hi = element.find(fmt::format("max_{}", kExtremes[i]));
            const bool there = std::max(lo, hi) < values.size();
            if (!there && i < 6)
                in.fail(fmt::format("packed Gaussian splats (element chunk, packed_position) without min_{0} and "
                                    "max_{0}; write them unpacked, with x, y, z",
                                    kExtremes[i]));
            chunk.lo[kExtremeOf[i]] = there ? values[lo] : 0; // colours of older files reach from 0 to 1
            chunk.hi[kExtremeOf[i]] = there ? values[hi] : 1;
        }
    }
    return chunks;
}

// The part of 1 that some bits of a word stand for.
double partOf(uint32_t word, unsigned shift, unsigned bits) {
    const uint32_t most = (1u << bits) - 1;
    return double(word >> shift & most) / double(most);
}
double between(const Chunk& chunk, Number number, double part) {
    return chunk.lo[number] + (chunk.hi[number] - chunk.lo[number]) * part;
}

// A unit quaternion as its three numbers but the largest, which is positive, in ten bits each, and which one that is.
void unpackRotation(double packed, Splat& splat) {
    const auto word = uint32_t(std::clamp(std::isfinite(packed) ? packed : 0, 0.0, 4294967295.0));
    const uint32_t largest = word >> 30;
    double squared = 0;
    for (uint32_t n = 0, shift = 20; n < 4; ++n) {
        if (n == largest) continue;
        const double number = (partOf(word, shift, 10) - 0.5) * 1.4142135623730951;
        splat[kRot0 + n] = number;
        squared += number * number;
        shift -= 10;
    }
    splat[kRot0 + largest] = std::sqrt(std::max(1 - squared, 0.0));
}

} // namespace

bool holdsSplats(const Element& vertex) {
    return vertex.has("x") && vertex.has("f_dc_0") && vertex.has("scale_0") && vertex.has("opacity");
}

Points readSplats(Reader& in, const Element& vertex, bool axes) {
    Points out;
    std::array<size_t, kNumbers> at{};
    for (size_t n = 0; n < kNumbers; ++n) {
        at[n] = in.find(vertex, kNames[n]);
        if (at[n] == vertex.properties.size() && n > kLog0 && n < kRot0) at[n] = at[n - 1]; // discs, and balls
        if (at[n] == vertex.properties.size() && n < kRot0)
            in.fail(fmt::format("element vertex has properties of Gaussian splatting, but no {}", kNames[n]));
    }
    size_t rest = 0;
    for (size_t p = 0; p < vertex.properties.size(); ++p) {
        const std::string& name = vertex.properties[p].name;
        if (name.starts_with("f_rest_"))
            ++rest;
        else if (!name.starts_with("rot_") && std::ranges::find(at, p) == at.end())
            out.ignored.push_back(name);
    }
    std::vector<double> values;
    for (uint64_t row = 0; row < vertex.count; ++row) {
        readRow(in, vertex, row, values);
        Splat splat;
        for (size_t n = 0; n < kNumbers; ++n) splat[n] = at[n] < values.size() ? values[at[n]] : 0;
        if (axes && at[kLog2] == at[kLog1] && at[kLog1] != at[kLog0]) splat[kLog2] = -1e3; // a disc is flat
        add(splat, in.rowNumber(), axes, out);
    }
    out.notes.push_back(
        fmt::format(kSplatNote, axes ? kAsEllipsoids : kAsBalls,
                    rest > 0 ? fmt::format(", the same from all sides ({} numbers of each are not read)", rest) : ""));
    return out;
}

bool holdsPackedSplats(const Header& header) {
    const Element* const vertex = header.find("vertex");
    return vertex && header.find("chunk") && vertex->has("packed_position");
}

Points readPackedSplats(Reader& in, const Header& header, bool axes) {
    Points out;
    std::vector<Chunk> chunks;
    in.find(header, "chunk"); // there is one
    for (const Element& element : header.elements) {
        if (element.name == "chunk") {
            chunks = readChunks(in, element);
        } else if (element.name == "vertex") {
            std::array<size_t, 3> at{};
            constexpr std::array<std::string_view, 3> kPacked{"packed_position", "packed_scale", "packed_color"};
            for (size_t i = 0; i < at.size(); ++i)
                if ((at[i] = in.find(element, kPacked[i])) == element.properties.size())
                    in.fail(
                        fmt::format("packed Gaussian splats (element chunk, packed_position) without {}", kPacked[i]));
            if (chunks.size() < (element.count + kOfChunk - 1) / kOfChunk)
                in.fail(fmt::format("packed Gaussian splats: {} of element chunk before {} of element vertex; expected "
                                    "one for each {}",
                                    rowsText(chunks.size()), rowsText(element.count), kOfChunk));
            const size_t rotation = in.find(element, "packed_rotation");
            for (size_t p = 0; p < element.properties.size(); ++p)
                if (p != rotation && std::ranges::find(at, p) == at.end())
                    out.ignored.push_back(element.properties[p].name);
            std::vector<double> values;
            for (uint64_t row = 0; row < element.count; ++row) {
                readRow(in, element, row, values);
                const auto word = [&](size_t i) {
                    return uint32_t(std::clamp(std::isfinite(values[at[i]]) ? values[at[i]] : 0, 0.0, 4294967295.0));
                };
                const uint32_t place = word(0), size = word(1), colour = word(2);
                const Chunk& chunk = chunks[size_t(row / kOfChunk)];
                Splat splat;
                const std::array<std::pair<unsigned, unsigned>, 3> fields{{{21, 11}, {11, 10}, {0, 11}}};
                for (size_t axis = 0; axis < 3; ++axis) {
                    const auto [shift, bits] = fields[axis];
                    splat[kPlaceX + axis] = between(chunk, Number(kPlaceX + axis), partOf(place, shift, bits));
                    splat[kLog0 + axis] = between(chunk, Number(kLog0 + axis), partOf(size, shift, bits));
                    const double part = partOf(colour, unsigned(24 - 8 * axis), 8);
                    splat[kDc0 + axis] = (between(chunk, Number(kDc0 + axis), part) - 0.5) / kHarmonic;
                }
                splat[kLogit] = 0;
                unpackRotation(rotation < values.size() ? values[rotation] : 0, splat);
                add(splat, in.rowNumber(), axes, out);
                out.columns[kOpacity].back() = partOf(colour, 0, 8);
            }
        } else {
            in.skip(element);
        }
    }
    out.notes.push_back(fmt::format(kSplatNote, axes ? kAsEllipsoids : kAsBalls, ""));
    return out;
}

} // namespace brume::ply
