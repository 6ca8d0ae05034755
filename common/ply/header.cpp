#include <algorithm>
#include <charconv>

#include <fmt/ranges.h>

#include "common/ply/reader.h"

namespace brume::ply {

namespace {

constexpr size_t kMostElements = 256, kMostProperties = 1024; // of an element
constexpr size_t kMostUnknown = 3, kLongestUnknown = 60;      // header lines that are told, and bytes of each

std::optional<Type> typeNamed(std::string_view name) {
    struct Named {
        std::string_view name;
        Type type;
    };
    constexpr Named kNames[]{{"char", Type::i8},    {"int8", Type::i8},   {"uchar", Type::u8},    {"uint8", Type::u8},
                             {"bool", Type::u8},    {"short", Type::i16}, {"int16", Type::i16},   {"ushort", Type::u16},
                             {"uint16", Type::u16}, {"int", Type::i32},   {"int32", Type::i32},   {"uint", Type::u32},
                             {"uint32", Type::u32}, {"int64", Type::i64}, {"long", Type::i64},    {"uint64", Type::u64},
                             {"ulong", Type::u64},  {"float", Type::f32}, {"float32", Type::f32}, {"double", Type::f64},
                             {"float64", Type::f64}};
    for (const Named& one : kNames)
        if (name == one.name) return one.type;
    return std::nullopt;
}

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
    if (word[1] == "ascii")
        header.format = Format::ascii;
    else if (word[1] == "binary_little_endian")
        header.format = Format::little_endian;
    else if (word[1] == "binary_big_endian")
        header.format = Format::big_endian;
    else
        in.fail("unknown format; expected ascii, binary_little_endian or binary_big_endian");
}

void readElement(Reader& in, const std::vector<std::string_view>& word, Header& header) {
    Element element;
    if (word.size() == 3) {
        element.name = word[1];
        const auto [stop, error] = std::from_chars(word[2].data(), word[2].data() + word[2].size(), element.count);
        if (error != std::errc() || stop != word[2].data() + word[2].size()) element.name.clear();
    }
    if (element.name.empty()) in.fail("expected \"element <name> <count>\"");
    if (header.elements.size() >= kMostElements) in.fail(fmt::format("more than {} elements", kMostElements));
    header.elements.push_back(std::move(element));
}

void readProperty(Reader& in, const std::vector<std::string_view>& word, Header& header) {
    if (header.elements.empty()) in.fail("a property before any element");
    const bool is_list = word.size() == 5 && word[1] == "list";
    if (!is_list && word.size() != 3)
        in.fail("expected \"property <type> <name>\" or \"property list <type> <type> <name>\"");
    const auto type = typeNamed(word[is_list ? 3 : 1]), length = is_list ? typeNamed(word[2]) : std::nullopt;
    if (!type || (is_list && !length))
        in.fail(fmt::format("property {} has an unknown type; expected char, uchar, short, ushort, int, uint, float or "
                            "double",
                            shortened(word.back(), kLongestUnknown)));
    if (length && isFloat(*length)) in.fail("a list's length is of a whole-number type");
    std::vector<Property>& properties = header.elements.back().properties;
    if (properties.size() >= kMostProperties)
        in.fail(fmt::format("element {} has more than {} properties",
                            shortened(header.elements.back().name, kLongestUnknown), kMostProperties));
    properties.push_back({std::string(word.back()), *type, length});
}

} // namespace

size_t Element::find(std::string_view property) const {
    return size_t(std::ranges::find(properties, property, &Property::name) - properties.begin());
}

const Element* Header::find(std::string_view name) const {
    for (const Element& element : elements)
        if (element.name == name) return &element;
    return nullptr;
}

Header readHeader(Reader& in) {
    if (words(in.headerLine()) != std::vector<std::string_view>{"ply"})
        in.fail("the first line is not \"ply\"; expected a PLY file");
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
        } else if (header.unknown.size() < kMostUnknown) {
            header.unknown.push_back(fmt::format("header line {} is unknown and passed over: {}", in.lineNumber(),
                                                 shortened(fmt::format("{}", fmt::join(word, " ")), kLongestUnknown)));
        }
    }
    if (!formatted) in.fail("no format line; expected \"format ascii 1.0\" or \"format binary_little_endian 1.0\"");
    in.beginBody(header.format);
    return header;
}

} // namespace brume::ply
