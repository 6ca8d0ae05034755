// Accessor: a list of numbers or vectors in a glTF file's buffers.
#pragma once

#include <glm/glm.hpp>

#include "common/gltf/file.h"

namespace brume::gltf {

// Components of an element.
enum class Shape { scalar = 1, vec2 = 2, vec3 = 3, vec4 = 4, mat4 = 16 };

const char* typeOf(Shape shape); // as in the file

class Accessor {
public:
    // Throws Wrong if it has another shape, or does not fit its buffer. The file must outlast it.
    Accessor(File& file, size_t index, Shape shape);

    // May be 0. Without a buffer view elements are zero and take no memory, however many they are.
    size_t count() const { return count_; }
    size_t parts() const { return parts_; } // numbers of an element
    // Component `part` of element i < count(); between -1 and 1, or 0 and 1, where it is normalised.
    double number(size_t i, size_t part) const { return raw(i, part, normalized_); }
    glm::dvec3 vec3(size_t i) const { return {number(i, 0), number(i, 1), number(i, 2)}; }
    // An index, whether it is normalised or not. Precondition: isWhole(), which is for unsigned whole numbers.
    size_t whole(size_t i, size_t part = 0) const;
    bool isWhole() const;

private:
    struct Column {
        const unsigned char* first = nullptr; // null: zeros
        size_t stride = 0;
        int component = 0; // as in the file: 5120 to 5126
        double number(size_t i, size_t part) const;
    };

    double raw(size_t i, size_t part, bool normalized) const;
    Column columnOf(File& file, const Json& of, size_t count, size_t parts, int component) const;

    size_t index_, count_ = 0, parts_;
    bool normalized_ = false;
    Column dense_;
    // Of a sparse one: elements that stand in for those of other indices, which grow.
    Column replaced_, replacements_;
    size_t replaced_count_ = 0;
};

} // namespace brume::gltf
