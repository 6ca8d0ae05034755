// The parts of a PLY file, ASCII or binary, version 1.0: its header, then value after value. Lines end with LF, CR and
// LF, or CR. Every read is bounded by the file's end. Every failure throws SceneError with one line that says where it
// is.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace brume::ply {

enum class Type { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
constexpr size_t sizeOf(Type type) {
    constexpr std::array<size_t, 10> kSize{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return kSize[static_cast<size_t>(type)];
}
inline bool isFloat(Type type) { return type == Type::f32 || type == Type::f64; }

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

    // The number of the first property of that name; none: properties.size().
    size_t find(std::string_view property) const;
    bool has(std::string_view property) const { return find(property) < properties.size(); }
};

enum class Format { ascii, little_endian, big_endian };

struct Header {
    Format format = Format::ascii;
    std::vector<Element> elements;
    std::vector<std::string> unknown; // header lines that no PLY file has, "3: hello"; the first few

    // The first element of that name; null: there is none.
    const Element* find(std::string_view name) const;
};

// "1 row", "3 rows".
std::string rowsText(uint64_t count);

class Reader {
public:
    // `file`: its name in messages. `text` must outlive the reader. A byte order mark of UTF-8 is passed over.
    // One of UTF-16 fails.
    Reader(std::string_view text, std::string file);

    // "file: PLY: what"; within the header "file:line: PLY: what".
    [[noreturn]] void fail(const std::string& what) const;

    // The number of the element's property of that name; none: the count of its properties. Fails if there are two.
    size_t find(const Element& element, std::string_view name) const;
    // The element of that name; null: there is none. Fails if there are two.
    const Element* find(const Header& header, std::string_view name) const;

    std::string_view headerLine();
    size_t lineNumber() const { return line_; } // of the last header line, from 1
    void beginBody(Format format);

    // For each row of an element: beginRow(), then all values of its properties in order, then endRow().
    void beginRow(const Element& element, uint64_t row);
    double value(const Property& property) {
        return ascii_ ? asciiValue(property) : binaryValue(property, property.type);
    }
    // A list's length: a whole number that the rest of the file could hold.
    uint64_t length(const Property& property);
    void endRow();
    // Where the row is that was begun last, counted from 1: its line, or in a binary file its number.
    size_t rowNumber() const { return ascii_ ? row_line_ : size_t(row_ + 1); }
    // "line 12" or "row 3".
    std::string rowName(size_t number) const;
    std::string rowName() const { return rowName(rowNumber()); }
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
    char line_end_ = '\n';
    bool ascii_ = true, swapped_ = false, in_header_ = true; // swapped_: numbers are big-endian
    const Element* element_ = nullptr;                       // the present row's element
    uint64_t row_ = 0;                                       // its number, counted from 0
    size_t row_line_ = 0, row_at_ = 0;                       // ASCII: line of the present row, place in it
};

// The header, up to the first value.
Header readHeader(Reader& in);

// Text of a file for a message: at most `most` bytes, with an ellipsis where it was longer.
std::string shortened(std::string_view text, size_t most);

} // namespace brume::ply
