#include "common/gltf/accessors.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace brume::gltf {
namespace {

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
              kFloat = 5126;

size_t bytesOf(int component) {
    switch (component) {
    case kByte:
    case kUnsignedByte:
        return 1;
    case kShort:
    case kUnsignedShort:
        return 2;
    case kUnsignedInt:
    case kFloat:
        return 4;
    default:
        return 0;
    }
}

// The number that stands for 1 where components are normalised.
double oneOf(int component) {
    switch (component) {
    case kByte:
        return std::numeric_limits<int8_t>::max();
    case kUnsignedByte:
        return std::numeric_limits<uint8_t>::max();
    case kShort:
        return std::numeric_limits<int16_t>::max();
    case kUnsignedShort:
        return std::numeric_limits<uint16_t>::max();
    default:
        return 1;
    }
}

template <class T>
double read(const unsigned char* from) {
    T value;
    std::memcpy(&value, from, sizeof(value));
    return double(value);
}

} // namespace

const char* typeOf(Shape shape) {
    switch (shape) {
    case Shape::scalar:
        return "SCALAR";
    case Shape::vec2:
        return "VEC2";
    case Shape::vec3:
        return "VEC3";
    case Shape::vec4:
        return "VEC4";
    case Shape::mat4:
        return "MAT4";
    }
    return "";
}

Accessor::Accessor(File& file, size_t index, Shape shape) : index_(index), parts_(size_t(shape)) {
    const Json& of = file.at("accessors", index);
    if (const std::string type = textIn(of, "type"); type != typeOf(shape))
        fail("accessors[{}] is {}; expected {}", index, shortened(type, 20), typeOf(shape));
    count_ = wholeIn(of, "count").value_or(0);
    normalized_ = flagIn(of, "normalized", false);
    const int component = int(std::min<size_t>(wholeIn(of, "componentType").value_or(0), 1u << 16));
    if (bytesOf(component) == 0) fail("accessors[{}] has componentType {}, which there is not", index, component);
    dense_ = columnOf(file, of, count_, parts_, component);
    const Json& sparse = member(of, "sparse");
    if (sparse.is_null()) return;
    replaced_count_ = wholeIn(sparse, "count").value_or(0);
    const Json& indices = member(sparse, "indices");
    const int whole = int(std::min<size_t>(wholeIn(indices, "componentType").value_or(0), 1u << 16));
    if (whole != kUnsignedByte && whole != kUnsignedShort && whole != kUnsignedInt)
        fail("accessors[{}] has sparse indices that are no unsigned whole numbers", index);
    replaced_ = columnOf(file, indices, replaced_count_, 1, whole);
    replacements_ = columnOf(file, member(sparse, "values"), replaced_count_, parts_, component);
    if (replaced_count_ > 0 && (!replaced_.first || !replacements_.first))
        fail("accessors[{}] is sparse without a bufferView of indices or of values", index);
    for (size_t i = 1; i < replaced_count_; ++i)
        if (!(replaced_.number(i - 1, 0) < replaced_.number(i, 0)))
            fail("accessors[{}] has sparse indices that do not grow", index);
}

Accessor::Column Accessor::columnOf(File& file, const Json& of, size_t count, size_t parts, int component) const {
    const std::optional<size_t> view_index = wholeIn(of, "bufferView");
    if (!view_index || count == 0) return {nullptr, 0, component};
    const ByteSpan data = file.view(*view_index);
    const size_t element = parts * bytesOf(component), offset = wholeIn(of, "byteOffset").value_or(0);
    const size_t given = wholeIn(file.at("bufferViews", *view_index), "byteStride").value_or(0);
    const size_t stride = given > 0 ? given : element;
    const bool fits = offset <= data.size() && element <= data.size() - offset && count <= data.size() + 1 &&
                      stride >> 32 == 0 && (count - 1) * stride <= data.size() - offset - element;
    if (!fits) fail("accessors[{}] is larger than its buffer", index_);
    return {data.data() + offset, stride, component};
}

double Accessor::Column::number(size_t i, size_t part) const {
    if (!first) return 0;
    const unsigned char* from = first + i * stride + part * bytesOf(component);
    switch (component) {
    case kByte:
        return read<int8_t>(from);
    case kUnsignedByte:
        return read<uint8_t>(from);
    case kShort:
        return read<int16_t>(from);
    case kUnsignedShort:
        return read<uint16_t>(from);
    case kUnsignedInt:
        return read<uint32_t>(from);
    default:
        return double(read<float>(from));
    }
}

double Accessor::raw(size_t i, size_t part, bool normalized) const {
    const Column* column = &dense_;
    if (replaced_count_ > 0) {
        size_t begin = 0, end = replaced_count_; // the first index that is not below i
        while (begin < end) {
            const size_t middle = (begin + end) / 2;
            if (replaced_.number(middle, 0) < double(i))
                begin = middle + 1;
            else
                end = middle;
        }
        if (begin < replaced_count_ && replaced_.number(begin, 0) == double(i)) {
            column = &replacements_;
            i = begin;
        }
    }
    const double value = column->number(i, part);
    return normalized ? std::max(value / oneOf(column->component), -1.0) : value;
}

bool Accessor::isWhole() const {
    return dense_.component == kUnsignedByte || dense_.component == kUnsignedShort || dense_.component == kUnsignedInt;
}

size_t Accessor::whole(size_t i, size_t part) const { return size_t(raw(i, part, false)); }

} // namespace brume::gltf
