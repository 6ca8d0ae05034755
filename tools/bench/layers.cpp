#include "tools/bench/layers.h"

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "tools/bench/error.h"
#include "tools/bench/layered_view.h"
#include "tools/bench/layers_over_time.h"

namespace brume::bench {
namespace {

constexpr uint32_t kCounts[] = {1, 2, 4, 8};
constexpr int kFrames = 12; // of which the fastest counts

struct Motion {
    const char* name;
    float sideways = 0, turned = 0; // m, degrees
};
constexpr Motion kMotions[] = {{"0"},           {"32 mm", 0.032f}, {"64 mm", 0.064f}, {"0.2 m", 0.2f},
                               {"0.5 m", 0.5f}, {"5°", 0, 5},      {"10°", 0, 10},    {"15°", 0, 15}};

Pose moved(const Pose& pose, const Motion& motion) {
    Pose out = pose;
    out.position += pose.orientation * glm::vec3(motion.sideways, 0, 0);
    out.orientation = glm::angleAxis(glm::radians(motion.turned), glm::vec3(0, 1, 0)) * pose.orientation;
    return out;
}

std::string tableOf(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question,
                    const std::string& wanted) {
    const size_t colon = wanted.find(':');
    Case one{.scene = wanted.substr(0, colon), .size = question.size};
    if (colon != wanted.npos) one.camera = wanted.substr(colon + 1);
    Stage stage(device, one, question.ticks, costs);
    const Pose shown = stage.pose(), made = wider(shown, question);
    const glm::uvec2 size = widerSize(question);
    const DisplaySettings display = displayOf(stage.scene().render);

    std::string out =
        fmt::format("## {}\n\n{}. Relative RMSE of the medium's pixels in %, FLIP in brackets.\n\n| moved |", wanted,
                    wayText(stage.plan().chosen.settings));
    out += " stays | rotation | plane |";
    std::vector<LayeredView> layered;
    for (const uint32_t count : kCounts) {
        layered.push_back(layeredView(stage, made, size, count, question.quality, kFrames));
        out += fmt::format(" {} |", count);
    }
    out += "\n|---|---|---|---|---|---|---|---|\n";
    const float target = glm::distance(shown.position, stage.scene().camera.target);
    for (const Motion& motion : kMotions) {
        const Pose eye = moved(shown, motion);
        const RadianceImage truth = stage.picture(eye, question.size);
        const std::vector<uint8_t> mask = mediumMask(truth);
        const auto error = [&](const RadianceImage& picture) {
            const Errors e = compare(picture, truth, display, mask);
            out += fmt::format(" {:.2f} ({:.4f}) |", 100 * e.relative_rmse, e.flip);
        };
        out += fmt::format("| {} |", motion.name);
        const LayeredPicture& flat = layered.front().picture;
        error(redrawn(distant(flat), shown, question.size));
        error(redrawn(distant(flat), eye, question.size));
        error(redrawn(asPlane(flat, target), eye, question.size));
        for (size_t i = 0; i < layered.size(); ++i) {
            const RadianceImage picture = redrawn(layered[i].picture, eye, question.size);
            error(picture);
            if (question.pictures.empty()) continue;
            const auto file = [&](const std::string& of) {
                return std::filesystem::path(question.pictures) /
                       fmt::format("{}-{}-{}.png", one.scene, motion.name, of);
            };
            writePng(file(std::to_string(kCounts[i])), picture.width, picture.height, displayed(picture, display));
            if (i == 0) writePng(file("true"), truth.width, truth.height, displayed(truth, display));
        }
        out += '\n';
    }
    out += "\n| layers | bytes flat | of layers | of surfaces | device, ms flat | with layers | encoding, ms flat "
           "| layers |\n"
           "|---|---|---|---|---|---|---|---|\n";
    for (size_t i = 0; i < layered.size(); ++i)
        out += fmt::format("| {} | {} | {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", kCounts[i],
                           layered[i].flat_bytes, layered[i].layer_bytes, layered[i].surface_bytes,
                           layered[i].device_ms, layered[i].device_layers_ms, layered[i].flat_ms, layered[i].layers_ms);
    if (question.over_time) out += overTime(device, costs, question, one) + arrivals(device, costs, question, one);
    return out + '\n';
}

} // namespace

std::string layersTables(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question) {
    std::string out;
    for (const std::string& scene : question.scenes) {
        fmt::print(stderr, "  {}\n", scene);
        out += tableOf(device, costs, question, scene);
    }
    return out;
}

} // namespace brume::bench
