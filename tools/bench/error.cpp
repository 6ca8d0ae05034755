#include "tools/bench/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace brume::bench {
std::vector<uint8_t> comparedPixels(const RadianceImage& reference, bool edges) {
    std::vector<uint8_t> mask = mediumMask(reference);
    for (size_t i = 0; i < mask.size(); ++i) {
        const bool edge = !reference.edges.empty() && reference.edges[i] != 0;
        if (edge != edges) mask[i] = 0;
    }
    return mask;
}

double MediumError::edgeShare() const {
    return double(edges.pixels) / double(std::max<size_t>(edges.pixels + medium.pixels, 1));
}

MediumError mediumError(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display) {
    MediumError error;
    error.edges_known = !reference.edges.empty();
    error.alone = value.medium_alone && reference.medium_alone;
    error.medium = compare(value, reference, display, comparedPixels(reference));
    const std::vector<uint8_t> edges = comparedPixels(reference, true);
    if (std::ranges::find(edges, 1) == edges.end()) {
        constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
        error.edges.relative_rmse = error.edges.bias = error.edges.flip = kNone;
        return error;
    }
    error.edges = compare(value, reference, display, edges);
    return error;
}

double samplingError(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display) {
    constexpr size_t kGroups = 20;
    std::vector<uint8_t> mask = comparedPixels(reference);
    std::vector<size_t> pixels;
    for (size_t i = 0; i < mask.size(); ++i)
        if (mask[i]) pixels.push_back(i);
    if (pixels.size() < 2 * kGroups) return std::numeric_limits<double>::quiet_NaN();
    double sum = 0, squares = 0;
    for (size_t group = 0; group < kGroups; ++group) {
        for (size_t i = group; i < pixels.size(); i += kGroups) mask[pixels[i]] = 0;
        const double without = compare(value, reference, display, mask).relative_rmse;
        for (size_t i = group; i < pixels.size(); i += kGroups) mask[pixels[i]] = 1;
        sum += without, squares += without * without;
    }
    const double variance = squares / kGroups - (sum / kGroups) * (sum / kGroups);
    return std::sqrt((kGroups - 1) * std::max(variance, 0.0));
}

std::string inShort(const MediumError& error) {
    std::string text = fmt::format("{:.3g} %", 100 * error.medium.relative_rmse);
    if (!error.edges_known) return text + "; edges not told apart";
    if (error.edges.pixels == 0) return text + "; no edges";
    return text + fmt::format("; edges {:.3g} %, {:.2g} % of pixels", 100 * error.edges.relative_rmse,
                              100 * error.edgeShare());
}

std::string describe(const MediumError& error) {
    std::string text = brume::describe(error.medium);
    if (!error.edges_known)
        text += "; edges of objects and shadows are not told apart: the reference has no channel E (brume-bench render "
                "--reference writes it)";
    else if (error.edges.pixels > 0)
        text += fmt::format("; edges: relative RMSE {:.3g} %, {} pixels ({:.2g} % of the medium's)",
                            100 * error.edges.relative_rmse, error.edges.pixels, 100 * error.edgeShare());
    else
        text += "; no edges";
    if (!error.alone)
        text += "\nnot the error that render.error promises: a picture has sky or ambient light; render both with "
                "--medium-alone";
    return text;
}

nlohmann::json toJson(const MediumError& error) {
    const Errors& e = error.medium;
    return {{"relative_rmse", e.relative_rmse},
            {"bias", e.bias},
            {"rel_mse", e.rel_mse},
            {"psnr", e.psnr},
            {"ssim", e.ssim},
            {"flip", e.flip},
            {"worst", {{"error", e.worst.error}, {"x", e.worst.x}, {"y", e.worst.y}}},
            {"pixels", e.pixels},
            {"not_finite", e.not_finite},
            {"edges", {{"relative_rmse", error.edges.relative_rmse}, {"share", error.edgeShare()}}}};
}

double partAbove(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display,
                 int levels) {
    const std::vector<glm::u8vec3> shown = displayed(value, display), right = displayed(reference, display);
    size_t above = 0;
    for (size_t i = 0; i < shown.size(); ++i) {
        const glm::ivec3 off = glm::abs(glm::ivec3(shown[i]) - glm::ivec3(right[i]));
        above += std::max({off.x, off.y, off.z}) > levels;
    }
    return double(above) / double(shown.size());
}

DisplaySettings displayOf(const RenderSettings& settings) { return {settings.exposure, settings.tone_map == "filmic"}; }

} // namespace brume::bench
