#include "tools/bench/layers_over_time.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "tools/bench/error.h"
#include "tools/bench/layered_view.h"

namespace brume::bench {
namespace {

constexpr uint32_t kRates[] = {60, 30, 15, 10, 5}; // pictures a second
constexpr uint32_t kLooks = 12, kLookEvery = 7;    // of a display at 60 Hz, and ticks between them

constexpr Path kPaths[] = {{"walks, 1.4 m/s", 1.4f}, {"orbits, 10°/s", 0, 10}};

Pose along(const Path& path, const Pose& pose, glm::vec3 target, float seconds) {
    Pose out = turnedAbout(pose, target, glm::radians(path.around) * seconds);
    out.position += out.orientation * glm::vec3(path.sideways * seconds, 0, 0);
    return out;
}

// Relative RMSE (%) and FLIP of what is seen, means over looks.
struct Sight {
    double error = 0, flip = 0;
};
std::string text(const Sight& s) { return fmt::format(" {:.2f} ({:.4f}) |", s.error, s.flip); }

} // namespace

// A picture of the server stays until the next one, and is redrawn at each look of the display. The medium goes on.
std::string overTime(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question,
                     const Case& one) {
    std::string out = "\n| camera | pictures/s | stay | plane | 4 layers |\n|---|---|---|---|---|\n";
    for (const Path& path : kPaths)
        for (const uint32_t rate : kRates) {
            Stage stage(device, one, question.ticks, costs);
            const DisplaySettings display = displayOf(stage.scene().render);
            const glm::vec3 target = stage.scene().camera.target;
            const Pose first = stage.pose();
            const uint32_t period = 60 / rate;
            Sight stays, plane, layers;
            std::optional<LayeredView> shown;
            Pose made;
            for (uint32_t tick = 0, looks = 0; looks < kLooks; ++tick, stage.step({})) {
                const Pose now = along(path, first, target, float(tick) / 60);
                if (tick % period == 0) {
                    made = now;
                    shown =
                        layeredView(stage, wider(now, question), widerSize(question), kLayersOfPage, question.quality);
                }
                if (tick % kLookEvery != 0) continue;
                ++looks;
                const RadianceImage truth = stage.picture(now, question.size);
                const std::vector<uint8_t> mask = mediumMask(truth);
                const auto add = [&](Sight& to, const LayeredPicture& p, const Pose& eye) {
                    const Errors e = compare(redrawn(p, eye, question.size), truth, display, mask);
                    to.error += 100 * e.relative_rmse / kLooks, to.flip += e.flip / kLooks;
                };
                const LayeredPicture& p = shown->picture;
                add(stays, distant(p), made);
                add(plane, asPlane(p, glm::distance(made.position, target)), now);
                add(layers, p, now);
            }
            out += fmt::format("| {} | {} |", path.name, rate) + text(stays) + text(plane) + text(layers) + '\n';
        }
    return out;
}

namespace {

constexpr uint32_t kShown = 48;        // pictures of the display
constexpr uint32_t kArrivesEvery = 12; // of them: five pictures a second come
constexpr float kBlended = 0.12f * 60; // of them, until a new picture covers the one before (client/web/src/fade.ts)
constexpr Path kSlowPaths[] = {{"walks, 0.3 m/s", 0.3f}, {"orbits, 5°/s", 0, 5}};

using Shown = std::vector<glm::vec3>; // sRGB, 0 ... 255

// RMS over pixels and colours of the second difference in time, of each picture but the first and last.
std::vector<double> jumpsOf(const std::vector<Shown>& film, const std::vector<uint8_t>& mask) {
    std::vector<double> out;
    for (size_t i = 1; i + 1 < film.size(); ++i) {
        double sum = 0, count = 0;
        for (size_t pixel = 0; pixel < film[i].size(); ++pixel) {
            if (!mask[pixel]) continue;
            const glm::vec3 jump = film[i - 1][pixel] - 2.0f * film[i][pixel] + film[i + 1][pixel];
            sum += double(glm::dot(jump, jump)), count += 3;
        }
        out.push_back(std::sqrt(sum / std::max(count, 1.0)));
    }
    return out;
}

std::string text(const std::vector<double>& jumps) {
    double mean = 0;
    for (const double one : jumps) mean += one / double(jumps.size());
    return fmt::format(" {:.2f} · {:.2f} |", mean, *std::ranges::max_element(jumps));
}

} // namespace

Jumps arrivalJumps(Stage& stage, const LayersQuestion& question, const Path& path, const std::string& film) {
    const DisplaySettings display = displayOf(stage.scene().render);
    const glm::vec3 target = stage.scene().camera.target;
    const auto shown = [&](const RadianceImage& picture) {
        const std::vector<glm::u8vec3> bytes = displayed(picture, display);
        return Shown(bytes.begin(), bytes.end());
    };
    std::vector<Shown> truth, stays, layers, blended;
    std::vector<uint8_t> mask;
    LayeredPicture before, newest;
    Pose made;
    for (uint32_t i = 0; i < kShown; ++i) {
        const Pose now = along(path, stage.pose(), target, float(i) / 60);
        const uint32_t age = i % kArrivesEvery;
        if (age == 0) {
            made = now;
            before = std::move(newest);
            newest =
                layeredView(stage, wider(now, question), widerSize(question), kLayersOfPage, question.quality).picture;
        }
        const RadianceImage there = stage.picture(now, question.size);
        if (mask.empty()) mask = mediumMask(there);
        truth.push_back(shown(there));
        stays.push_back(shown(redrawn(distant(newest), made, question.size)));
        layers.push_back(shown(redrawn(newest, now, question.size)));
        blended.push_back(layers.back());
        const float part = std::min(float(age) / kBlended, 1.0f);
        if (!before.picture.empty() && part < 1) {
            const Shown old = shown(redrawn(before, now, question.size));
            for (size_t p = 0; p < old.size(); ++p) blended.back()[p] = glm::mix(old[p], layers.back()[p], part);
        }
        if (film.empty()) continue;
        const std::vector<glm::u8vec3> bytes(blended.back().begin(), blended.back().end());
        writePng(fmt::format("{}-{:02}.png", film, i), int(question.size.x), int(question.size.y), bytes);
    }
    return {jumpsOf(truth, mask), jumpsOf(stays, mask), jumpsOf(layers, mask), jumpsOf(blended, mask)};
}

std::string arrivals(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question,
                     const Case& one) {
    std::string out = "\n| camera | true pictures | old ones stay | 4 layers | blended in |\n|---|---|---|---|---|\n";
    for (const Path& path : kSlowPaths) {
        Stage stage(device, one, question.ticks, costs);
        std::string film;
        if (!question.pictures.empty())
            film = (std::filesystem::path(question.pictures) / (one.scene + (path.around > 0 ? "-orbit" : "-walk")))
                       .string();
        const Jumps jumps = arrivalJumps(stage, question, path, film);
        out += fmt::format("| {} |", path.name);
        for (const auto* kind : {&jumps.truth, &jumps.stays, &jumps.layers, &jumps.blended}) out += text(*kind);
        out += '\n';
    }
    return out;
}

} // namespace brume::bench
