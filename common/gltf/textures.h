// Textures: what colour a base colour texture has on a triangle.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "common/gltf/file.h"

namespace brume::gltf {

inline constexpr int kMostTexels = 4096; // a side, of an image
inline constexpr size_t kMostTexelsInAll =
    32 * size_t(kMostTexels) * kMostTexels; // texels of all images that are decoded

// An image in halves of halves, down to one texel.
class Image {
public:
    // Throws Wrong unless it is PNG or JPEG within kMostTexels and `left` texels, from which its own are taken. It
    // keeps at most `most` bytes: a larger one is kept coarser. With `transparent` colours count by their alpha,
    // otherwise alpha is 1.
    Image(const Bytes& file, bool transparent, size_t most, size_t& left);

    // The mean of a square of `area` (of the whole image) around a place, (0, 0) its first corner; linear, with alpha.
    glm::vec4 at(glm::dvec2 place, double area) const;
    glm::vec4 mean() const { return mean_; }
    size_t bytes() const;

private:
    struct Level {
        int width, height;
        std::vector<glm::u8vec4> texels; // sRGB, alpha linear
    };
    static Level coarser(const Level& from, int factor);

    std::vector<Level> levels_;
    glm::vec4 mean_{1};
};

// How a material's texture lies on triangles.
struct Texture {
    std::shared_ptr<const Image> image;       // null: none
    size_t set = 0;                           // n of TEXCOORD_n
    glm::dmat3x2 transform{1, 0, 0, 1, 0, 0}; // place in the image = transform * (u, v, 1)
    int wrap[2]{10497, 10497};                // as in the file

    glm::dvec2 placeOf(glm::dvec2 uv) const; // in [0, 1]
    // Of a triangle with these coordinates at its corners.
    glm::vec4 colourOf(const glm::dvec2 (&uv)[3]) const;
};

class Textures {
public:
    explicit Textures(File& file) : file_(file) {}

    // `info`: a textureInfo of a material, or null. What cannot be read is told, and has no image.
    Texture read(const Json& info, bool transparent);

private:
    std::shared_ptr<const Image> imageOf(size_t index, bool transparent);

    File& file_;
    std::map<std::pair<size_t, bool>, std::shared_ptr<const Image>> images_;
    size_t left_ = kMostBytes; // bytes that images in memory may still take
    size_t texels_left_ = kMostTexelsInAll;
};

} // namespace brume::gltf
