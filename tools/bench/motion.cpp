#include "tools/bench/motion.h"

#include <cmath>
#include <cstdio>

#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "tools/bench/error.h"
#include "tools/bench/motion_errors.h"

namespace brume::bench {
namespace {

using nlohmann::json;

constexpr uint64_t kHistory = 1; // EyeRequest::history: frames of a stage follow each other

// A stage that moves on by a frame, and where its camera is then.
class Moving {
public:
    Moving(const gpu::Device& device, const Case& wanted, const Motion& motion, const std::string& mover)
        : stage_(device, wanted, motion.ticks), motion_(motion), mover_(mover), frame_(-int(motion.lead)),
          first_(stage_.simulation().now()), pose_(stage_.pose()) {
        places_ = {pose_};
        for (const std::string& place : motion.places)
            places_.push_back(poseOf(place, stage_.scene(), stage_.simulation()));
        if (mover == "lamp" && first_.lists.lights.empty())
            throw SceneError(wanted.scene + ": movers = [\"lamp\"]: it has neither point nor spot");
    }

    void next() {
        std::vector<Command> commands;
        if (fresh_) {
            commands.push_back({.body = Set{{"simulation.paused", !moves("particles")}}});
            if (moves("particles"))
                commands.push_back({.body = Impulse{pose_.position, pose_.orientation * glm::vec3(0, 0, -1)}});
        }
        const glm::quat turn = glm::angleAxis(glm::radians(motion_.light_degrees * float(frame_)), glm::vec3(0, 1, 0));
        if (moves("sun")) commands.push_back({.body = Set{{"light.to_light", turn * first_.light.to_light}}});
        if (moves("lamp") && !first_.lists.lights.empty()) {
            const Light& lamp = first_.lists.lights.front();
            commands.push_back({.body = Set{{"light[0].position", lamp.pivot + turn * (lamp.position - lamp.pivot)}}});
        }
        stage_.step(commands);
        if (moves("camera")) pose_ = cameraAt(frame_);
        fresh_ = false;
        ++frame_;
    }

    Stage& stage() { return stage_; }
    const Pose& pose() const { return pose_; }
    size_t place() const { return place_; } // the nearest one

private:
    bool moves(const char* what) const { return mover_ == what || mover_ == "all"; }

    Pose cameraAt(int frame) {
        if (places_.size() == 1)
            return turnedAbout(places_[0], stage_.scene().camera.target, glm::radians(motion_.degrees * float(frame)));
        const float way = float(places_.size() - 1) * float(std::max(frame, 0)) / float(motion_.frames - 1);
        place_ = size_t(std::lround(way));
        const size_t from = std::min(size_t(way), places_.size() - 2);
        const Pose &a = places_[from], &b = places_[from + 1];
        Pose pose = a;
        pose.position = glm::mix(a.position, b.position, way - float(from));
        pose.orientation = glm::normalize(glm::slerp(a.orientation, b.orientation, way - float(from)));
        return pose;
    }

    Stage stage_;
    const Motion& motion_;
    const std::string& mover_;
    int frame_; // the next one; negative: of the lead
    const SceneNow first_;
    Pose pose_;
    std::vector<Pose> places_;
    size_t place_ = 0;
    bool fresh_ = true;
};

// What one case's frames were.
struct Seen {
    std::vector<RadianceImage> pictures, exact; // `exact` is empty beside a case
    std::vector<double> ms;
    std::vector<size_t> places;
};

json timeOf(std::span<const double> ms) {
    const Spread spread = spreadOf(ms);
    return {{"frames", ms.size()},
            {"mean", spread.mean},
            {"deviation", spread.deviation},
            {"variance", spread.deviation * spread.deviation}};
}

json timesOfPlaces(const Seen& seen, size_t count) {
    json all = json::array();
    for (size_t place = 0; place < count; ++place) {
        std::vector<double> ms;
        for (size_t i = 0; i < seen.ms.size(); ++i)
            if (seen.places[i] == place) ms.push_back(seen.ms[i]);
        all.push_back(timeOf(ms));
    }
    return all;
}

json toJson(const MotionErrors& errors) {
    return {{"relative_rmse", errors.mean},
            {"rmse_deviation", errors.deviation},
            {"rmse_greatest", errors.rmse[errors.greatest]},
            {"greatest_frame", errors.greatest},
            {"flicker", errors.flicker},
            {"temporal_flip", errors.temporal_flip},
            {"lag", errors.lag},
            {"ghost", errors.ghost},
            {"ratio_least", errors.ratio.least},
            {"ratio_greatest", errors.ratio.greatest}};
}

// All cases frame by frame, in turns: what disturbs the machine disturbs all alike.
std::vector<Seen> seenBy(const std::vector<std::unique_ptr<Moving>>& all, const Motion& motion, Truth& truth) {
    std::vector<Seen> seen(all.size());
    for (uint32_t frame = 0; frame < motion.lead + motion.frames; ++frame)
        for (size_t i = 0; i < all.size(); ++i) {
            Moving& one = *all[i];
            one.next();
            if (frame < motion.lead || !motion.errors) {
                const double ms = one.stage().timed(one.pose(), motion.size, kHistory);
                if (frame < motion.lead) continue;
                seen[i].ms.push_back(ms);
            } else {
                seen[i].pictures.push_back(
                    thinned(one.stage().picture(one.pose(), motion.size, kHistory), motion.every));
                seen[i].ms.push_back(one.stage().deviceMs());
                if (!motion.beside)
                    seen[i].exact.push_back(truth.of(one.stage(), one.pose(), motion.size, motion.every));
            }
            seen[i].places.push_back(one.place());
        }
    return seen;
}

} // namespace

json motionRows(const gpu::Device& device, const std::vector<NamedCase>& cases, const Motion& motion, Truth& truth) {
    json rows = json::array();
    for (const std::string& mover : motion.movers) {
        std::vector<std::unique_ptr<Moving>> all;
        for (const NamedCase& one : cases) all.push_back(std::make_unique<Moving>(device, one.wanted, motion, mover));
        const std::vector<Seen> seen = seenBy(all, motion, truth);
        for (size_t i = 0; i < cases.size(); ++i) {
            json row = {{"scene", cases[i].wanted.scene},
                        {"camera", cases[i].wanted.camera},
                        {"size", std::to_string(motion.size.x) + 'x' + std::to_string(motion.size.y)},
                        {"mover", mover},
                        {"variant", cases[i].name},
                        {"set", cases[i].wanted.set},
                        {"frames", motion.frames},
                        {"degrees", motion.degrees},
                        {"light_degrees", motion.light_degrees},
                        {"ms", timeOf(seen[i].ms)}};
            if (!motion.places.empty()) row["places"] = timesOfPlaces(seen[i], motion.places.size() + 1);
            std::fprintf(stderr, "  %-12s %-9s %-28s %8.1f ms", cases[i].wanted.scene.c_str(), mover.c_str(),
                         cases[i].name.c_str(), row["ms"]["mean"].get<double>());
            if (motion.errors) {
                const std::vector<RadianceImage>& exact = motion.beside ? seen[*motion.beside].pictures : seen[i].exact;
                const MotionErrors errors =
                    motionErrors(seen[i].pictures, exact, displayOf(all[i]->stage().scene().render));
                row.update(toJson(errors));
                std::fprintf(stderr, "  error %.3f %%, flicker %.4f %%, FLIP %+.5f, lag %.2f of %.0f %%",
                             100 * errors.mean, 100 * errors.flicker, errors.temporal_flip, errors.lag,
                             100 * errors.ghost);
            }
            std::fputc('\n', stderr);
            rows.push_back(std::move(row));
        }
    }
    return rows;
}

} // namespace brume::bench
