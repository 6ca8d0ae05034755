// MediumError: how far a picture of the medium is from its reference. All that measures takes this one definition;
// docs/conventions.md has it as formulas.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/metrics.h"
#include "common/scene.h"

namespace brume::bench {

// Pixels that show the medium, in two parts. Errors of a part without pixels are NaN.
struct MediumError {
    Errors medium;           // where no edge crosses the pixel: what the plan predicts
    Errors edges;            // where an edge of an object or of its shadow crosses it
    bool edges_known = true; // False: the reference does not say where edges are, and `medium` holds all pixels
    bool alone = true;       // True: neither picture has sky or ambient light, as the plan's promise asks

    double edgeShare() const; // of the pixels that show the medium, in [0, 1]
};

// 1 for pixels that show the medium and are no edges, or are edges.
std::vector<uint8_t> comparedPixels(const RadianceImage& reference, bool edges = false);

// `reference`: of Truth, or read from what `brume-bench render --reference` wrote. Throws std::invalid_argument if
// sizes differ.
MediumError mediumError(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display);

// Standard error of medium.relative_rmse where the pixels are a random sample of a picture's: jackknife over 20
// groups. NaN below 40 pixels.
double samplingError(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display);

// Both errors in one line, and a second line if they are not what the plan's promise is about.
std::string describe(const MediumError& error);
// "relative_rmse", "bias" and so on, of the medium; "edges" holds "relative_rmse" and "share".
nlohmann::json toJson(const MediumError& error);
// "0.28 %; edges 11 % of 4.4 % of the pixels".
std::string inShort(const MediumError& error);

// The part of all pixels of which a channel, as a display shows it, differs by more than `levels` of 255.
double partAbove(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display,
                 int levels);

// What the scene does to radiance before it is shown.
DisplaySettings displayOf(const RenderSettings& settings);
// Settings that leave the medium and its objects alone: no sky, no ambient light, no haze.
inline constexpr const char* kMediumAlone[] = {"sky.zenith=[0,0,0]", "sky.horizon=[0,0,0]", "sky.ambient=[0,0,0]",
                                               "sky.haze=0"};

} // namespace brume::bench
