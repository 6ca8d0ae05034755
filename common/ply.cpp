#include "common/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include <spdlog/spdlog.h>

#include "common/scene.h"
#include "common/scene_limits.h"
#include "common/text.h"

namespace brume {

namespace {

constexpr uint64_t kMostBytes = 512ull << 20; // a million points of 64 doubles
constexpr size_t kLongestLine = 1024, kMostLines = 512, kMostElements = 16, kMostProperties = 64;

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };
constexpr std::array<size_t, 8> kSize{1, 1, 2, 2, 4, 4, 4, 8};

std::optional<Type> typeNamed(std::string_view name) {
    constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};
    for (size_t i = 0; i < kNames.size(); ++i)
        if (name == kNames[i][0] || name == kNames[i][1]) return static_cast<Type>(i);
    return std::nullopt;
}

struct Property {
    std::string name;
    Type type = Type::f32;
    std::optional<Type> list; // the type of a list's length
};

struct Element {
    std::string name;
    uint64_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    bool ascii = true;
    std::vector<Element> elements;
};

// The file's text with a place in it. Every read is bounded by the text's end and fails with what was expected there.
class Reader {
public:
    Reader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

    [[noreturn]] void fail(const std::string& what) const {
        throw SceneError(oneLine(file_ + (line_ ? ':' + std::to_string(line_) : "") + ": PLY: " + what));
    }

    std::string_view headerLine() {
        if (++line_ > kMostLines) fail("the header has more than 512 lines; is end_header missing?");
        const size_t end = text_.find('\n', at_);
        if (end == std::string_view::npos) fail("the file ends inside its header; expected end_header");
        if (end - at_ > kLongestLine)
            fail("a header line is longer than 1024 bytes; allowed: the header of a PLY file");
        std::string_view line = text_.substr(at_, end - at_);
        at_ = end + 1;
        if (line.ends_with('\r')) line.remove_suffix(1);
        return line;
    }
    void endHeader(bool ascii) {
        ascii_ = ascii;
        line_ = 0;
    }

    double value(Type type) { return ascii_ ? asciiValue() : binaryValue(type); }
    // A list's length: a small whole number that the rest of the file could hold.
    uint64_t length(Type type) {
        const double number = value(type);
        if (!(number >= 0) || number != std::floor(number) || number > static_cast<double>(text_.size() - at_))
            fail("a list's length is not a whole number that the file could hold");
        return static_cast<uint64_t>(number);
    }
    // Passes over `count` records of `bytes` bytes each.
    void skipBinary(uint64_t count, uint64_t bytes) {
        if (bytes && count > (text_.size() - at_) / bytes) failShort();
        at_ += count * bytes;
    }
    bool ascii() const { return ascii_; }

private:
    [[noreturn]] void failShort() const { fail("the file ends early; expected the points that its header announces"); }

    double asciiValue() {
        constexpr std::string_view kBlank = " \t\r\n\v\f";
        const size_t begin = std::min(text_.find_first_not_of(kBlank, at_), text_.size());
        if (begin == text_.size()) failShort();
        const size_t end = std::min(text_.find_first_of(kBlank, begin), text_.size());
        const char* first = text_.data() + begin;
        const char* last = text_.data() + end;
        at_ = end;
        if (*first == '+') ++first;
        double number = 0;
        const auto [stop, error] = std::from_chars(first, last, number);
        if (error == std::errc::result_out_of_range)
            return std::numeric_limits<double>::infinity(); // dropped like any such point
        if (error != std::errc() || stop != last)
            fail("\"" + std::string(text_.substr(begin, std::min<size_t>(end - begin, 40))) + "\" is not a number");
        return number;
    }

    template <class T>
    double take() {
        if (text_.size() - at_ < sizeof(T)) failShort();
        T number;
        std::memcpy(&number, text_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        return static_cast<double>(number);
    }
    double binaryValue(Type type) {
        static_assert(std::endian::native == std::endian::little);
        switch (type) {
        case Type::i8:
            return take<int8_t>();
        case Type::u8:
            return take<uint8_t>();
        case Type::i16:
            return take<int16_t>();
        case Type::u16:
            return take<uint16_t>();
        case Type::i32:
            return take<int32_t>();
        case Type::u32:
            return take<uint32_t>();
        case Type::f32:
            return take<float>();
        case Type::f64:
            return take<double>();
        }
        return 0;
    }

    std::string_view text_;
    std::string file_;
    size_t at_ = 0, line_ = 0;
    bool ascii_ = true;
};

std::vector<std::string_view> words(std::string_view line) {
    std::vector<std::string_view> out;
    for (size_t at = 0; (at = line.find_first_not_of(" \t", at)) != std::string_view::npos;) {
        const size_t end = std::min(line.find_first_of(" \t", at), line.size());
        out.push_back(line.substr(at, end - at));
        at = end;
    }
    return out;
}

void readFormat(Reader& in, const std::vector<std::string_view>& word, Header& header) {
    if (word.size() != 3 || word[2] != "1.0")
        in.fail("expected \"format ascii 1.0\" or \"format binary_little_endian 1.0\"");
    if (word[1] == "binary_big_endian")
        in.fail("big-endian files are not read; write it as binary_little_endian or ascii");
    if (word[1] != "ascii" && word[1] != "binary_little_endian")
        in.fail("unknown format; expected ascii or binary_little_endian");
    header.ascii = word[1] == "ascii";
}

void readElement(Reader& in, const std::vector<std::string_view>& word, Header& header) {
    Element element;
    if (word.size() == 3) {
        element.name = word[1];
        const auto [stop, error] = std::from_chars(word[2].data(), word[2].data() + word[2].size(), element.count);
        if (error != std::errc() || stop != word[2].data() + word[2].size()) element.name.clear();
    }
    if (element.name.empty()) in.fail("expected \"element <name> <count>\"");
    if (header.elements.size() >= kMostElements) in.fail("more than 16 elements");
    header.elements.push_back(std::move(element));
}

void readProperty(Reader& in, const std::vector<std::string_view>& word, Header& header) {
    if (header.elements.empty()) in.fail("a property before any element");
    const bool is_list = word.size() == 5 && word[1] == "list";
    if (!is_list && word.size() != 3)
        in.fail("expected \"property <type> <name>\" or \"property list <type> <type> <name>\"");
    const auto type = typeNamed(word[is_list ? 3 : 1]), length = is_list ? typeNamed(word[2]) : std::nullopt;
    if (!type || (is_list && !length))
        in.fail("unknown type; expected char, uchar, short, ushort, int, uint, float or double");
    if (length == Type::f32 || length == Type::f64) in.fail("a list's length is of a whole-number type");
    std::vector<Property>& properties = header.elements.back().properties;
    if (properties.size() >= kMostProperties) in.fail("more than 64 properties");
    properties.push_back({std::string(word.back()), *type, length});
}

Header readHeader(Reader& in) {
    if (in.headerLine() != "ply") in.fail("the first line is not \"ply\"; expected a PLY file");
    Header header;
    bool formatted = false;
    for (;;) {
        const std::vector<std::string_view> word = words(in.headerLine());
        if (word.empty() || word[0] == "comment" || word[0] == "obj_info") continue;
        if (word[0] == "end_header") break;
        if (word[0] == "format") {
            readFormat(in, word, header);
            formatted = true;
        } else if (word[0] == "element") {
            readElement(in, word, header);
        } else if (word[0] == "property") {
            readProperty(in, word, header);
        } else {
            in.fail("unknown header line; expected format, element, property, comment or end_header");
        }
    }
    if (!formatted) in.fail("no format line; expected \"format ascii 1.0\" or \"format binary_little_endian 1.0\"");
    in.endHeader(header.ascii);
    return header;
}

void skip(Reader& in, const Element& element) {
    uint64_t bytes = 0;
    bool lists = false;
    for (const Property& p : element.properties) {
        bytes += kSize[static_cast<size_t>(p.type)];
        lists |= p.list.has_value();
    }
    if (element.properties.empty()) return; // any number of nothing
    if (!lists && !in.ascii()) return in.skipBinary(element.count, bytes);
    for (uint64_t i = 0; i < element.count; ++i)
        for (const Property& p : element.properties)
            for (uint64_t n = p.list ? in.length(*p.list) : 1; n > 0; --n) in.value(p.type);
}

// Where the vertex element keeps what we take.
enum Slot : size_t { kX, kY, kZ, kScale, kSigmaT, kRed, kGreen, kBlue, kSlots };
constexpr std::array<std::string_view, kSlots> kSlotNames{"x", "y", "z", "scale", "sigma_t", "red", "green", "blue"};

struct Columns {
    std::vector<size_t> slot_of; // per property; kSlots: not taken
    std::array<bool, kSlots> there{};
    std::array<double, kSlots> unit{1, 1, 1, 1, 1, 1, 1, 1}; // what a file's number is multiplied by
};

Columns columnsOf(Reader& in, const Element& vertex) {
    Columns out;
    for (const Property& p : vertex.properties) {
        size_t slot = 0;
        while (slot < kSlots && p.name != kSlotNames[slot]) ++slot;
        out.slot_of.push_back(slot);
        if (slot == kSlots) continue;
        if (p.list) in.fail("vertex property " + p.name + " is a list; expected one number");
        if (out.there[slot]) in.fail("vertex property " + p.name + " is there twice");
        out.there[slot] = true;
        if (slot < kRed) continue;
        const bool is_float = p.type == Type::f32 || p.type == Type::f64;
        if (!is_float && p.type != Type::u8)
            in.fail("vertex property " + p.name + " has an odd type; expected uchar (0 to 255) or float (0 to 1)");
        out.unit[slot] = is_float ? 1.0 : 1.0 / 255;
    }
    if (!out.there[kX] || !out.there[kY] || !out.there[kZ]) in.fail("element vertex lacks one of x, y, z");
    if (out.there[kRed] != out.there[kGreen] || out.there[kRed] != out.there[kBlue])
        in.fail("element vertex has some of red, green, blue; expected all or none");
    return out;
}

bool usable(const std::array<double, kSlots>& v, const Columns& columns) {
    constexpr std::array<Limits, kSlots> kAllowed{limits::kPlace,  limits::kPlace,  limits::kPlace,  limits::kScale,
                                                  limits::kSigmaT, limits::kColour, limits::kColour, limits::kColour};
    for (size_t s = 0; s < kSlots; ++s)
        if (columns.there[s] && !kAllowed[s].holds(v[s])) return false;
    return true;
}

PointCloud readPoints(Reader& in, const Element& vertex, glm::dvec3 origin) {
    const Columns columns = columnsOf(in, vertex);
    PointCloud out;
    for (uint64_t i = 0; i < vertex.count; ++i) {
        std::array<double, kSlots + 1> v{}; // the last takes what is not wanted
        for (size_t p = 0; p < vertex.properties.size(); ++p) {
            const Property& property = vertex.properties[p];
            for (uint64_t n = property.list ? in.length(*property.list) : 1; n > 0; --n)
                v[columns.slot_of[p]] = in.value(property.type);
        }
        std::array<double, kSlots> taken;
        for (size_t s = 0; s < kSlots; ++s) taken[s] = v[s] * columns.unit[s];
        for (int axis = 0; axis < 3; ++axis) taken[kX + static_cast<size_t>(axis)] -= origin[axis];
        if (!usable(taken, columns)) {
            ++out.dropped;
            continue;
        }
        out.position.emplace_back(taken[kX], taken[kY], taken[kZ]);
        if (columns.there[kScale]) out.scale.push_back(static_cast<float>(taken[kScale]));
        if (columns.there[kSigmaT]) out.sigma_t.push_back(static_cast<float>(taken[kSigmaT]));
        if (columns.there[kRed]) out.albedo.emplace_back(taken[kRed], taken[kGreen], taken[kBlue]);
    }
    return out;
}

std::string readBytes(const std::filesystem::path& file) {
    std::error_code error;
    const bool regular = std::filesystem::is_regular_file(file, error);
    const uint64_t size = regular ? std::filesystem::file_size(file, error) : 0;
    std::ifstream in(file, std::ios::binary);
    if (!regular || error || !in)
        throw SceneError(file.string() + ": PLY: cannot be read; expected a point cloud file");
    if (size > kMostBytes) throw SceneError(file.string() + ": PLY: larger than 512 MiB");
    std::string bytes(size, '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(size));
    bytes.resize(static_cast<size_t>(in.gcount()));
    return bytes;
}

} // namespace

PointCloud loadPly(const std::filesystem::path& file, glm::dvec3 origin) {
    return parsePly(readBytes(file), file.string(), origin);
}

PointCloud parsePly(std::string_view bytes, const std::string& name, glm::dvec3 origin) {
    Reader in(bytes, name);
    const Header header = readHeader(in);
    for (const Element& element : header.elements) {
        if (element.name != "vertex") {
            skip(in, element);
            continue;
        }
        if (!limits::kCount.holds(static_cast<double>(element.count)))
            in.fail("element vertex has " + std::to_string(element.count) + " points; allowed: 1 to 1000000");
        PointCloud cloud = readPoints(in, element, origin);
        if (cloud.position.empty())
            in.fail("no point is usable; expected finite x y z within 50 km of the scene's origin (origin = [x, y, "
                    "z] at its top), scale from 0.001 to 1000, sigma_t from 0 to 10000, colours uchar or float "
                    "from 0 to 1");
        if (cloud.dropped)
            spdlog::warn("{}: dropped {} of {} points: a number is not finite or out of range (a place: within 50 km "
                         "of the scene's origin)",
                         name, cloud.dropped, element.count);
        return cloud;
    }
    in.fail("no element vertex; expected one with x, y, z");
}

} // namespace brume
