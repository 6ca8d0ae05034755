#include "common/ply/reader.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "common/scene.h"
#include "common/text.h"

namespace brume::ply {

namespace {

constexpr size_t kMostHeaderBytes = 1 << 20, kMostLines = 20'000;
constexpr size_t kLongestLine = 1024;                   // bytes, of a header line that is no comment
constexpr size_t kLongestName = 40, kLongestList = 200; // bytes, in messages
constexpr std::string_view kBlank = " \t\r\n\v\f";

std::string propertiesOf(const Element& element) {
    std::string names;
    for (const Property& p : element.properties)
        names += (names.empty() ? "" : ", ") + std::string(p.list ? "list " : "") + p.name;
    return shortened(names, kLongestList);
}

// True: a line of the header that programs ignore.
bool isComment(std::string_view line) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    return word == "comment" || word == "obj_info";
}

bool isNumber(std::string_view text, double& number) {
    const char* const last = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + text.starts_with('+'), last, number);
    // What is too large for a double is dropped with its point, what is too small is nothing.
    if (error == std::errc::result_out_of_range) {
        const size_t exponent = std::min(text.find_first_of("eE"), text.size() - 1);
        number = text.substr(exponent + 1).starts_with('-') ? 0 : std::numeric_limits<double>::infinity();
    }
    if (stop == last && (error == std::errc() || error == std::errc::result_out_of_range)) return true;
    // Programs of one compiler write "-1.#IND", "1.#QNAN" and "1.#INF".
    const size_t mark = text.find("1.#");
    if (mark > 1 || (mark == 1 && text[0] != '-' && text[0] != '+')) return false;
    const bool infinite = text.substr(mark + 3).starts_with("INF");
    number = infinite ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
    return true;
}

} // namespace

std::string shortened(std::string_view text, size_t most) {
    return text.size() <= most ? std::string(text) : std::string(text.substr(0, most)) + "...";
}

std::string rowsText(uint64_t count) { return fmt::format("{} row{}", count, count == 1 ? "" : "s"); }

Reader::Reader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {
    if (text_.starts_with("\xff\xfe") || text_.starts_with("\xfe\xff"))
        fail("text of two bytes a character (UTF-16); save it as ASCII or UTF-8");
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
    const size_t end = text_.find_first_of("\r\n");
    if (end != text_.npos && text_.substr(end, 2) != "\r\n") line_end_ = text_[end];
}

void Reader::fail(const std::string& what) const {
    throw SceneError(oneLine(file_ + (in_header_ && line_ ? ':' + std::to_string(line_) : "") + ": PLY: " + what));
}

size_t Reader::find(const Element& element, std::string_view name) const {
    const size_t found = element.find(name);
    for (size_t p = found + 1; p < element.properties.size(); ++p)
        if (element.properties[p].name == name) fail(fmt::format("{} property {} is there twice", element.name, name));
    return found;
}

const Element* Reader::find(const Header& header, std::string_view name) const {
    const Element* const found = header.find(name);
    if (found && std::ranges::count(header.elements, name, &Element::name) > 1)
        fail(fmt::format("element {} is there twice", name));
    return found;
}

void Reader::failAt(const Property& property, const std::string& what) const {
    const std::string name = shortened(property.name, kLongestName);
    throw SceneError(oneLine(ascii_ ? fmt::format("{}:{}: PLY: property {}: {}", file_, row_line_, name, what)
                                    : fmt::format("{}: PLY: row {} of element {}, property {}: {}", file_, row_ + 1,
                                                  shortened(element_->name, kLongestName), name, what)));
}

void Reader::failShort(const Property& property) const {
    const std::string element = shortened(element_->name, kLongestName);
    if (ascii_)
        fail(fmt::format("the file ends early, after {} of {} rows of element {}", row_, element_->count, element));
    fail(fmt::format("the file ends early, in row {} of {} of element {}, property {}", row_ + 1, element_->count,
                     element, shortened(property.name, kLongestName)));
}

void Reader::failLine() const {
    const size_t begin = text_.rfind(line_end_, row_at_) + 1; // npos + 1 is 0
    const std::string_view line = text_.substr(begin, text_.find(line_end_, row_at_) - begin);
    size_t values = 0;
    for (size_t at = 0; (at = line.find_first_not_of(kBlank, at)) != line.npos; ++values)
        at = std::min(line.find_first_of(kBlank, at), line.size());
    const bool lists = std::any_of(element_->properties.begin(), element_->properties.end(),
                                   [](const Property& p) { return p.list.has_value(); });
    throw SceneError(
        oneLine(fmt::format("{}:{}: PLY: the line has {} values; a row of element {} has {}: {}", file_, row_line_,
                            values, shortened(element_->name, kLongestName),
                            lists ? "others" : std::to_string(element_->properties.size()), propertiesOf(*element_))));
}

std::string_view Reader::headerLine() {
    if (++line_ > kMostLines) fail("the header has more than 20000 lines; is end_header missing?");
    const size_t end = text_.find(line_end_, at_);
    if (end == std::string_view::npos) {
        const bool no_lines = line_ == 1 && text_.starts_with("ply") && text_.find('\r') == std::string_view::npos;
        fail(std::string("the file ends inside its header; expected end_header") +
             (no_lines ? "; sent with curl -d? It takes out line ends: use --data-binary" : ""));
    }
    std::string_view line = text_.substr(at_, end - at_);
    if (end > kMostHeaderBytes) fail("the header is longer than 1 MiB; is end_header missing?");
    at_ = end + 1;
    if (line_end_ == '\n' && line.ends_with('\r')) line.remove_suffix(1);
    if (line.size() > kLongestLine && !isComment(line))
        fail("a header line is longer than 1024 bytes; expected a PLY file, whose comments alone may be so long");
    return line;
}

void Reader::beginBody(Format format) {
    ascii_ = format == Format::ascii;
    swapped_ = format == Format::big_endian;
    in_header_ = false;
    ++line_;
}

void Reader::skipBlanks() {
    for (; at_ < text_.size() && kBlank.find(text_[at_]) != kBlank.npos; ++at_) line_ += text_[at_] == line_end_;
}

void Reader::beginRow(const Element& element, uint64_t row) {
    element_ = &element;
    row_ = row;
    if (!ascii_) return;
    skipBlanks();
    row_line_ = line_;
    row_at_ = at_;
}

void Reader::endRow() {
    if (!ascii_) return;
    skipBlanks();
    if (line_ == row_line_ && at_ < text_.size()) failLine();
}

std::string Reader::rowName(size_t number) const { return fmt::format("{} {}", ascii_ ? "line" : "row", number); }

uint64_t Reader::length(const Property& property) {
    const double number = ascii_ ? asciiValue(property) : binaryValue(property, *property.list);
    if (!(number >= 0) || number != std::floor(number) || number > static_cast<double>(text_.size() - at_))
        failAt(property,
               fmt::format("a list's length is {}; expected a whole number that the file could hold", number));
    return static_cast<uint64_t>(number);
}

void Reader::skip(const Element& element) {
    if (element.properties.empty()) return; // any number of nothing
    const bool lists = std::any_of(element.properties.begin(), element.properties.end(),
                                   [](const Property& p) { return p.list.has_value(); });
    if (!lists && !ascii_) {
        uint64_t bytes = 0;
        for (const Property& p : element.properties) bytes += sizeOf(p.type);
        if (element.count > (text_.size() - at_) / bytes)
            fail(fmt::format("the file ends early, in the {} rows of element {}", element.count,
                             shortened(element.name, kLongestName)));
        at_ += element.count * bytes;
        return;
    }
    for (uint64_t row = 0; row < element.count; ++row) {
        beginRow(element, row);
        for (const Property& p : element.properties)
            for (uint64_t n = p.list ? length(p) : 1; n > 0; --n) value(p);
        endRow();
    }
}

double Reader::asciiValue(const Property& property) {
    skipBlanks();
    if (at_ == text_.size() && at_ == row_at_) failShort(property);
    if (at_ == text_.size() || line_ != row_line_) failLine();
    const std::string_view word = text_.substr(at_, text_.find_first_of(kBlank, at_) - at_);
    at_ += word.size();
    double number = 0;
    if (isNumber(word, number)) return number;
    std::string point(word.substr(0, kLongestName));
    std::replace(point.begin(), point.end(), ',', '.');
    const std::string quoted = '"' + shortened(word, kLongestName) + "\" is not a number";
    if (isNumber(point, number)) failAt(property, quoted + "; is its comma a decimal point? expected " + point);
    failAt(property, quoted + "; expected numbers like 0.5 with blanks between them");
}

template <class T>
double Reader::take(const Property& property) {
    if (text_.size() - at_ < sizeof(T)) failShort(property);
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if (swapped_) std::ranges::reverse(bytes);
    return static_cast<double>(std::bit_cast<T>(bytes));
}

double Reader::binaryValue(const Property& property, Type type) {
    static_assert(std::endian::native == std::endian::little);
    switch (type) {
    case Type::i8:
        return take<int8_t>(property);
    case Type::u8:
        return take<uint8_t>(property);
    case Type::i16:
        return take<int16_t>(property);
    case Type::u16:
        return take<uint16_t>(property);
    case Type::i32:
        return take<int32_t>(property);
    case Type::u32:
        return take<uint32_t>(property);
    case Type::i64:
        return take<int64_t>(property);
    case Type::u64:
        return take<uint64_t>(property);
    case Type::f32:
        return take<float>(property);
    case Type::f64:
        return take<double>(property);
    }
    return 0;
}

} // namespace brume::ply
