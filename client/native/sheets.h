// Sheets: a picture with one layer with depth as two meshes of textured triangles, so that a graphics card redraws it
// as seen from where the eye is by now (protocol/README.md, Layers with depth). What the display shows is added, not
// light. That is less exact than common/redraw, which takes hundreds of milliseconds. Of several layers some would have
// to add more than a texture holds.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/native/jpeg.h"
#include "client/native/session.h"
#include "common/camera.h"

namespace brume::client {

// One texture, on a lattice of places with depth. Drawn in order: each lets through `transmittance` of what is there,
// and adds `colours`.
struct Sheet {
    int width = 0, height = 0;          // texels of both textures
    std::vector<uint8_t> transmittance; // B, G, R, 255; empty: it hides all behind it
    std::vector<uint8_t> colours;       // the same; what the sheet adds
    struct Corner {
        float x, y;  // pixels of the picture, from its upper left corner
        float u, v;  // place in the textures, 0 ... 1
        float depth; // m, along the view axis; infinite: the sky
    };
    std::vector<Corner> corners; // four of each patch: upper left, upper right, lower left, lower right
};

// A corner where another eye sees it. u, v as in Sheet.
struct Vertex {
    float x, y, u, v; // x, y: parts of the shown picture's width and height, from its upper left corner
};

class Sheets {
public:
    // Nothing if the frame has not one view with one layer, or if that cannot be read.
    static std::optional<Sheets> of(const Received& message, JpegDecoder& decoder);

    const std::array<Sheet, 2>& all() const { return sheets_; } // first what is behind the layer

    // Where `eye`, which sees `width` / `height` = `aspect`, sees the corners of a sheet. A patch that is behind the
    // eye has four equal corners.
    std::vector<Vertex> seen(const Sheet& sheet, const Pose& eye, float aspect) const;

private:
    Pose made_;
    float width_ = 0, height_ = 0; // pixels of the picture
    std::array<Sheet, 2> sheets_;
};

} // namespace brume::client
