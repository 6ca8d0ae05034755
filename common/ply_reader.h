// The parts of a PLY file, ASCII or binary little-endian, version 1.0: its header, then value after value. Every read
// is bounded by the file's end. Every failure throws SceneError with one line that says where it is.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace brume::ply {

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };
constexpr size_t sizeOf(Type type) {
    constexpr std::array<size_t, 8> kSize{1, 1, 2, 2, 4, 4, 4, 8};
    return kSize[static_cast<size_t>(type)];
}

struct Property {
    std::string name;
    Type type = Type::f32;
    std::optional<Type> list{}; // the type of a list's length
};

// Rows of equal properties. A row of an ASCII file is a line.
struct Element {
    std::string name;
    uint64_t count = 0; // number of rows
    std::vector<Property> properties;
};

struct Header {
    bool ascii = true;
    std::vector<Element> elements;
};

class Reader {
public:
    // `file`: its name in messages. `text` must outlive the reader.
    Reader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

    // "file: PLY: what"; within the header "file:line: PLY: what".
    [[noreturn]] void fail(const std::string& what) const;

    std::string_view headerLine();
    void beginBody(bool ascii);

    // For each row of an element: beginRow(), then all values of its properties in order, then endRow().
    void beginRow(const Element& element, uint64_t row);
    double value(const Property& property) {
        return ascii_ ? asciiValue(property) : binaryValue(property, property.type);
    }
    // A list's length: a whole number that the rest of the file could hold.
    uint64_t length(const Property& property);
    void endRow();
    // "line 12" or "row 3", counted from 1: where the row is that was begun last.
    std::string rowName() const;
    // Passes over all rows of an element. Its properties are any.
    void skip(const Element& element);

private:
    [[noreturn]] void failAt(const Property& property, const std::string& what) const;
    [[noreturn]] void failShort(const Property& property) const;
    [[noreturn]] void failLine() const;
    double asciiValue(const Property& property);
    double binaryValue(const Property& property, Type type);
    template <class T>
    double take(const Property& property);
    void skipBlanks();

    std::string_view text_;
    std::string file_;
    size_t at_ = 0, line_ = 0; // line_: number of the line that holds at_, counted from 1
    bool ascii_ = true, in_header_ = true;
    const Element* element_ = nullptr; // the present row's element
    uint64_t row_ = 0;                 // its number, counted from 0
    size_t row_line_ = 0, row_at_ = 0; // ASCII: line of the present row, place in it
};

// The header, up to the first value.
Header readHeader(Reader& in);

// Text of a file for a message: at most `most` bytes, with an ellipsis where it was longer.
std::string shortened(std::string_view text, size_t most);

} // namespace brume::ply
