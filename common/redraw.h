// Redraw: a picture as it would be from a place nearby, made of its layers with depth (shaders/shared/depth_layers.h)
// alone. What a viewer does between two pictures of the server; the page does the same in client/web/src/redraw.ts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "common/camera.h"

namespace brume {

// A picture with its layers, as they come from the server. Rows from the top left.
struct LayeredPicture {
    Pose eye;                         // with the frustum that was drawn
    uint32_t width = 0, height = 0;   // pixels
    float exposure = 1;               // factor of all radiance
    bool filmic = false;              // True: colours are tone mapped (DisplaySettings)
    std::vector<glm::u8vec3> picture; // sRGB

    uint32_t count = 0;             // layers, near to far
    uint32_t columns = 0, rows = 0; // nodes of a layer
    float spacing = 1, first = 0;   // pixels between nodes, and to the first, each way
    float near = 1, far = 1;        // m, view depths of bytes 0 and 255
    // sRGB of count * rows * columns nodes, as seen with nothing in front. Without surfaces there are rows * columns
    // more: the sky behind all layers.
    std::vector<glm::u8vec3> colours;
    std::vector<uint8_t> transmittance; // the same
    std::vector<uint8_t> depth;

    std::vector<uint8_t> surface; // width * height bytes of depth; empty: nothing but sky
};

// What is behind layers, smooth: `rest`, the light of a picture besides theirs, over what they let through; from
// farther around where that is little. Both have width * height places. Of `layers` the last number counts, their
// transmittance. `smooth`: it is a mean over squares of 2^smooth places at least.
std::vector<glm::vec3> seenThrough(std::span<const glm::vec3> rest, std::span<const glm::vec4> layers, uint32_t width,
                                   uint32_t height, size_t smooth);

class Redraw {
public:
    // Takes apart what the picture shows: what each layer sends, and what is behind all of them.
    explicit Redraw(const LayeredPicture& picture);

    // Linear radiance as seen by another eye: width * height pixels. What the picture does not show is continued by
    // what is nearest to it.
    void draw(const Pose& eye, uint32_t width, uint32_t height, std::span<glm::vec3> out) const;

private:
    // A view of the picture's place: what shows where.
    struct View {
        glm::vec3 position;
        glm::mat3 axes; // right, up, back
        Frustum frustum;
    };
    std::vector<glm::vec4> everywhere(const std::vector<glm::vec4>& nodes) const;
    glm::vec2 pixelOf(glm::vec3 seen) const; // of a point in the picture's own view, whose depth is positive
    float depthAt(uint32_t layer, glm::vec2 pixel) const;
    float surfaceAt(glm::vec2 pixel) const;
    glm::vec2 meet(uint32_t layer, glm::vec3 from, glm::vec3 dir, float& depth) const;
    glm::vec2 meetSurface(glm::vec3 from, glm::vec3 dir, float& depth) const;

    View made_;
    uint32_t width_, height_, count_, columns_, rows_;
    float spacing_, first_, exposure_;
    std::vector<std::vector<glm::vec4>> layers_; // of each pixel: colour with nothing in front, and transmittance
    std::vector<std::vector<float>> depths_;     // of each node, m
    std::vector<float> surface_;                 // of each pixel, m; infinite: the sky
    float nearest_ = 0;                          // m, of surface_
    std::vector<glm::vec3> behind_;              // of each pixel: what is behind all layers
};

} // namespace brume
