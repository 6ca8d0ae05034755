#include "common/volume/volume.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "common/plain_file.h"
#include "common/ply/extent.h"
#include "common/scene.h"
#include "common/scene_limits.h"
#include "common/text.h"
#include "common/volume/gzip.h"

namespace brume {
namespace {

constexpr uint64_t kMostBytes = 1ull << 30, kMostVoxels = 512ull << 20;
constexpr size_t kLongestHeader = 64 << 10, kLongestShown = 40;
constexpr double kCube = 1e-3; // by which a voxel's sides may differ

enum class Number { i8, u8, i16, u16, i32, u32, f32, f64 };

struct Type {
    Number number;
    size_t bytes;
    double whole; // that stands for 1
};
std::optional<Type> typeOf(std::string_view name) {
    static const std::map<std::string_view, Type> kTypes{{"signed char", {Number::i8, 1, 127}},
                                                         {"int8", {Number::i8, 1, 127}},
                                                         {"int8_t", {Number::i8, 1, 127}},
                                                         {"uchar", {Number::u8, 1, 255}},
                                                         {"unsigned char", {Number::u8, 1, 255}},
                                                         {"uint8", {Number::u8, 1, 255}},
                                                         {"uint8_t", {Number::u8, 1, 255}},
                                                         {"short", {Number::i16, 2, 32767}},
                                                         {"short int", {Number::i16, 2, 32767}},
                                                         {"int16", {Number::i16, 2, 32767}},
                                                         {"int16_t", {Number::i16, 2, 32767}},
                                                         {"ushort", {Number::u16, 2, 65535}},
                                                         {"unsigned short", {Number::u16, 2, 65535}},
                                                         {"uint16", {Number::u16, 2, 65535}},
                                                         {"uint16_t", {Number::u16, 2, 65535}},
                                                         {"int", {Number::i32, 4, 2147483647.0}},
                                                         {"int32", {Number::i32, 4, 2147483647.0}},
                                                         {"int32_t", {Number::i32, 4, 2147483647.0}},
                                                         {"uint", {Number::u32, 4, 4294967295.0}},
                                                         {"unsigned int", {Number::u32, 4, 4294967295.0}},
                                                         {"uint32", {Number::u32, 4, 4294967295.0}},
                                                         {"uint32_t", {Number::u32, 4, 4294967295.0}},
                                                         {"float", {Number::f32, 4, 1}},
                                                         {"double", {Number::f64, 8, 1}}};
    const auto found = kTypes.find(name);
    return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

template <class T>
double valueOf(const char* bytes, bool swap) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (swap) std::ranges::reverse(raw);
    return double(std::bit_cast<T>(raw));
}
double valueOf(const char* bytes, Number number, bool swap) {
    switch (number) {
    case Number::i8:
        return valueOf<int8_t>(bytes, swap);
    case Number::u8:
        return valueOf<uint8_t>(bytes, swap);
    case Number::i16:
        return valueOf<int16_t>(bytes, swap);
    case Number::u16:
        return valueOf<uint16_t>(bytes, swap);
    case Number::i32:
        return valueOf<int32_t>(bytes, swap);
    case Number::u32:
        return valueOf<uint32_t>(bytes, swap);
    case Number::f32:
        return valueOf<float>(bytes, swap);
    case Number::f64:
        break;
    }
    return valueOf<double>(bytes, swap);
}

// The numbers of a field, whatever is between them.
std::vector<double> numbersIn(std::string_view text) {
    std::vector<double> out;
    constexpr std::string_view kBetween = " \t(),";
    while (!text.empty()) {
        const size_t first = text.find_first_not_of(kBetween);
        if (first == text.npos) break;
        text.remove_prefix(first);
        const size_t length = std::min(text.find_first_of(kBetween), text.size());
        double number = std::numeric_limits<double>::quiet_NaN();
        std::from_chars(text.data(), text.data() + length, number);
        out.push_back(number);
        text.remove_prefix(length);
    }
    return out;
}

class NrrdReader {
public:
    NrrdReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    Volume read(const PlyFrame& frame) {
        readHeader();
        Volume out;
        const glm::uvec3 size = sizeOf();
        const auto type = typeOf(field("type"));
        if (!type) fail("type is " + shown(field("type")) + "; allowed: whole numbers of 8 to 32 bits, float, double");
        const std::string& encoding = field("encoding");
        if (encoding != "raw" && encoding != "gzip" && encoding != "gz")
            fail("encoding is " + shown(encoding) + "; allowed: raw, gzip, gz (of pynrrd: {'encoding': 'gzip'})");
        const std::string& endian = field("endian");
        if (type->bytes > 1 && endian != "little" && endian != "big")
            fail("endian is " + shown(endian) + "; allowed: little, big");
        const uint64_t wanted = uint64_t(size.x) * size.y * size.z * type->bytes;
        if (encoding != "raw") unpack(wanted);
        if (bytes_.size() < wanted) fail(fmt::format("it ends after {} of {} bytes of voxels", bytes_.size(), wanted));
        place(frame, size, out);
        take(frame, size, *type, (endian == "big") != (std::endian::native == std::endian::big), out);
        return out;
    }

private:
    [[noreturn]] void fail(const std::string& what) const { throw SceneError(oneLine(name_ + ": NRRD: " + what)); }
    static std::string shown(const std::string& text) {
        return text.empty() ? "not given" : "\"" + text.substr(0, kLongestShown) + "\"";
    }
    const std::string& field(const std::string& key) const {
        static const std::string kNothing;
        const auto found = fields_.find(key);
        return found == fields_.end() ? kNothing : found->second;
    }

    std::string_view line() {
        const size_t end = bytes_.substr(0, kLongestHeader).find('\n');
        if (end == bytes_.npos) fail("its header has no end: a blank line before the voxels");
        std::string_view one = bytes_.substr(0, end);
        bytes_.remove_prefix(end + 1);
        if (one.ends_with('\r')) one.remove_suffix(1);
        return one;
    }

    void readHeader() {
        if (!bytes_.starts_with("NRRD000")) throw SceneError(name_ + ": no volume; expected a file of the format NRRD");
        line();
        const size_t before = bytes_.size();
        for (std::string_view one = line(); !one.empty(); one = line()) {
            if (before - bytes_.size() > kLongestHeader) fail("its header is longer than 64 KiB");
            const size_t colon = one.find(": ");
            if (one.starts_with('#') || colon == one.npos) continue; // comments, and key:=value
            std::string_view value = one.substr(colon + 2);
            while (value.ends_with(' ')) value.remove_suffix(1);
            fields_[std::string(one.substr(0, colon))] = std::string(value);
        }
        for (const char* key : {"data file", "datafile"})
            if (fields_.contains(key)) fail("its voxels are in another file; write them into it (.nrrd, not .nhdr)");
        for (const char* key : {"line skip", "lineskip", "byte skip", "byteskip"})
            if (fields_.contains(key) && field(key) != "0") fail(fmt::format("{} is not read", key));
    }

    void unpack(uint64_t wanted) {
        if (wanted > kMostBytes) fail(fmt::format("its voxels take {} bytes; allowed: 1 GiB", wanted));
        if (const std::string why = unpackGzip(bytes_, wanted, unpacked_); !why.empty()) fail(why);
        bytes_ = unpacked_;
    }

    glm::uvec3 sizeOf() const {
        if (field("dimension") != "3")
            fail("dimension is " + shown(field("dimension")) + "; allowed: 3, one number for each voxel");
        const std::vector<double> sizes = numbersIn(field("sizes"));
        double voxels = 1;
        for (const double size : sizes) voxels *= size >= 1 && size == std::floor(size) ? size : NAN;
        if (sizes.size() != 3 || !(voxels <= double(kMostVoxels)))
            fail("sizes are " + shown(field("sizes")) + "; allowed: three whole numbers, together up to 512 Mi voxels");
        return {uint32_t(sizes[0]), uint32_t(sizes[1]), uint32_t(sizes[2])};
    }

    // Sets where the voxels are.
    void place(const PlyFrame& frame, glm::uvec3 size, Volume& out) {
        std::vector<double> directions = numbersIn(field("space directions")),
                            origin = numbersIn(field("space origin"));
        if (directions.empty()) {
            const std::vector<double> spacings = numbersIn(field("spacings"));
            const auto spacing = [&](size_t i) { return spacings.size() == 3 ? spacings[i] : 1; };
            directions = {spacing(0), 0, 0, 0, spacing(1), 0, 0, 0, spacing(2)};
        }
        if (origin.empty()) origin = {0, 0, 0};
        const auto finite = [](double x) { return std::isfinite(x); };
        if (directions.size() != 9 || origin.size() != 3 || !std::ranges::all_of(directions, finite) ||
            !std::ranges::all_of(origin, finite))
            fail("space directions or space origin are not three numbers each");
        const double width = std::abs(directions[0]);
        for (size_t i = 0; i < 9; ++i) {
            const bool along = i % 4 == 0;
            if (!(width > 0) || std::abs(std::abs(directions[i]) - (along ? width : 0)) > kCube * width)
                fail("voxels are no cubes along the axes: space directions or spacings " +
                     shown(field("space directions") + field("spacings")) + "; resample them");
            if (along) signs_[i / 4] = directions[i] > 0 ? 1 : -1;
        }
        out.spacing = width * frame.unit;
        // The file's axes in the scene: each is one of the scene's, the same way or the other.
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 unit(0);
            unit[axis] = signs_[size_t(axis)];
            axes_[size_t(axis)] = glm::ivec3(ply::turned(unit, frame.up));
        }
        out.size = glm::uvec3(0);
        glm::dvec3 lowest = ply::turned({origin[0], origin[1], origin[2]}, frame.up) * frame.unit - frame.origin;
        for (int axis = 0; axis < 3; ++axis) {
            const glm::ivec3 way = axes_[size_t(axis)];
            out.size += size[axis] * glm::uvec3(glm::abs(way));
            lowest += double(size[axis] - 1) * out.spacing * glm::dvec3(glm::min(way, glm::ivec3(0)));
        }
        out.origin = lowest;
        if (glm::any(
                glm::greaterThan(glm::abs(lowest) + glm::dvec3(out.size) * out.spacing, glm::dvec3(limits::kPlace.hi))))
            fail("its voxels reach beyond 50 km from the scene's origin (origin, medium.unit)");
    }

    void take(const PlyFrame& frame, glm::uvec3 size, Type type, bool swap, Volume& out) const {
        out.extinction.assign(size_t(out.size.x) * out.size.y * out.size.z, 0);
        const auto stride = [&](size_t axis) { // of the scene's list, along the file's axis
            const glm::ivec3 way = axes_[axis];
            return int64_t(way.x) + int64_t(way.y) * out.size.x + int64_t(way.z) * out.size.x * out.size.y;
        };
        const int64_t step[3]{stride(0), stride(1), stride(2)};
        int64_t first = 0;
        for (size_t axis = 0; axis < 3; ++axis)
            if (step[axis] < 0) first -= step[axis] * int64_t(size[int(axis)] - 1);
        const char* from = bytes_.data();
        size_t wrong = 0;
        for (uint32_t k = 0; k < size.z; ++k)
            for (uint32_t j = 0; j < size.y; ++j) {
                int64_t to = first + int64_t(k) * step[2] + int64_t(j) * step[1];
                for (uint32_t i = 0; i < size.x; ++i, from += type.bytes, to += step[0]) {
                    const double value = valueOf(from, type.number, swap) / (type.whole * frame.unit);
                    const bool usable = value >= 0 && value <= limits::kSigmaT.hi;
                    wrong += !usable;
                    out.extinction[size_t(to)] = usable                              ? float(value)
                                                 : value > 0 && std::isfinite(value) ? float(limits::kSigmaT.hi)
                                                                                     : 0;
                }
            }
        if (wrong > 0)
            out.notes.push_back(fmt::format("{} voxels are below 0, no number, or above {} 1/m: they count as 0 or as "
                                            "that",
                                            wrong, limits::kSigmaT.hi));
    }

    std::string_view bytes_;
    std::string unpacked_;
    const std::string& name_;
    std::map<std::string, std::string> fields_;
    std::array<int, 3> signs_{};
    std::array<glm::ivec3, 3> axes_{};
};

// Each voxel is the mean of eight. Beyond the ends is nothing.
Volume halved(const Volume& volume) {
    Volume out{(volume.size + 1u) / 2u, volume.origin + 0.5 * volume.spacing, 2 * volume.spacing, {}, volume.notes};
    out.extinction.reserve(size_t(out.size.x) * out.size.y * out.size.z);
    for (uint32_t z = 0; z < out.size.z; ++z)
        for (uint32_t y = 0; y < out.size.y; ++y)
            for (uint32_t x = 0; x < out.size.x; ++x) {
                float sum = 0;
                for (int i = 0; i < 8; ++i)
                    sum += volume.at(2 * glm::ivec3(x, y, z) + glm::ivec3(i & 1, i >> 1 & 1, i >> 2));
                out.extinction.push_back(sum / 8);
            }
    return out;
}

} // namespace

Volume parseVolume(std::string_view bytes, const std::string& name, const PlyFrame& frame, uint64_t most) {
    Volume out = NrrdReader(bytes, name).read(frame);
    const glm::uvec3 before = out.size;
    while (out.nodes() > most && glm::any(glm::greaterThan(out.size, glm::uvec3(1)))) out = halved(out);
    if (out.size != before)
        out.notes.push_back(fmt::format("its {} x {} x {} voxels are merged to {} x {} x {}, which memory allows",
                                        before.x, before.y, before.z, out.size.x, out.size.y, out.size.z));
    if (std::ranges::none_of(out.extinction, [](float x) { return x > 0; }))
        throw SceneError(oneLine(name + ": NRRD: no voxel is above 0"));
    return out;
}

bool isNrrd(std::string_view bytes) { return bytes.starts_with("NRRD"); }

PlyExtent volumeExtentOf(std::string_view bytes, const std::string& name, const std::string& up) {
    const Volume volume = parseVolume(bytes, name, {.up = up}, std::numeric_limits<uint64_t>::max());
    const glm::dvec3 half = 0.5 * volume.spacing * (glm::dvec3(volume.size) - 1.0);
    return {.middle = volume.origin + half,
            .radius = std::max({half.x, half.y, half.z}),
            .count = volume.extinction.size()};
}

Volume loadVolume(const std::filesystem::path& file, const PlyFrame& frame, uint64_t most) {
    std::error_code error;
    const bool regular = std::filesystem::is_regular_file(file, error);
    const uint64_t size = regular ? std::filesystem::file_size(file, error) : 0;
    if (!std::filesystem::exists(file, error))
        throw SceneError(file.string() + ": no such file; a relative medium.file counts from the scene's folder");
    std::ifstream in = openPlain(file);
    if (!regular || error || !in) throw SceneError(file.string() + ": cannot be read; expected a volume's file");
    if (size > kMostBytes) throw SceneError(file.string() + ": NRRD: larger than 1 GiB");
    std::string bytes(size, '\0');
    in.read(bytes.data(), std::streamsize(size));
    bytes.resize(size_t(in.gcount()));
    return parseVolume(bytes, file.string(), frame, most);
}

} // namespace brume
