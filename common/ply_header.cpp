#include <array>
#include <charconv>

#include "common/ply_reader.h"

namespace brume::ply {

namespace {

constexpr size_t kMostElements = 16, kMostProperties = 64;

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

} // namespace

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
    in.beginBody(header.ascii);
    return header;
}

} // namespace brume::ply
