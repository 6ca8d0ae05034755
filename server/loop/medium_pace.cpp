#include "server/loop/medium_pace.h"

#include <algorithm>
#include <cmath>

namespace brume {
namespace {

constexpr uint32_t kParticles = 256; // particles that are looked at, at most
constexpr uint64_t kTicksApart = 12;
constexpr std::chrono::seconds kDisturbed{1};
// Change that a picture tolerates, in parts of a particle's scale or extinction. Of the shipped scenes `plume` and
// `smoke-spots` change by that within a tick or two, the others by nothing.
constexpr double kTolerated = 0.1;
constexpr double kTurnTolerated = 0.01; // rad, of the sun's direction or a lamp's orbit

} // namespace

void MediumPace::look(const Simulation& simulation) {
    const uint64_t tick = simulation.tick();
    if (tick_ && tick >= *tick_ && tick < *tick_ + kTicksApart) return;
    const uint32_t live = simulation.liveCount(), every = (live + kParticles - 1) / kParticles;
    now_.resize(every == 0 ? 0 : (live + every - 1) / every);
    if (every > 0) simulation.write(now_, every);
    // A mean over a longer time says little of now.
    const bool same = tick_ && tick > *tick_ && tick <= *tick_ + 2 * kTicksApart && now_.size() == before_.size();
    known_ = false;
    if (same && simulation.now().simulation.paused) {
        known_ = true, change_ = 0;
    } else if (same) {
        double sum = 0;
        for (size_t i = 0; i < now_.size(); ++i) {
            const double moved =
                double(glm::distance(now_[i].centre, before_[i].centre) / std::max(now_[i].scale, 1e-6f));
            const double most = double(std::max({now_[i].sigma_t, before_[i].sigma_t, 1e-30f}));
            sum += moved * moved + std::pow(double(now_[i].sigma_t - before_[i].sigma_t) / most, 2);
        }
        const double seconds = double(tick - *tick_) * kTickSeconds;
        change_ = std::sqrt(sum / double(std::max<size_t>(now_.size(), 1))) / seconds;
        float turns = std::abs(simulation.now().light.rotate); // rad/s
        for (const Light& light : simulation.now().lists.lights) turns = std::max(turns, std::abs(light.orbit));
        change_ = std::max(change_, double(turns) * kTolerated / kTurnTolerated);
        known_ = true;
    }
    std::swap(before_, now_);
    tick_ = tick;
}

Clock::duration MediumPace::lasts(Clock::time_point now) const {
    if (!known_ || now - disturbed_ < kDisturbed) return {};
    constexpr std::chrono::duration<double> kMost = kLongest;
    const auto seconds = std::chrono::duration<double>(kTolerated / std::max(change_, kTolerated / kMost.count()));
    return seconds.count() < kTickSeconds ? Clock::duration{} : std::chrono::duration_cast<Clock::duration>(seconds);
}

} // namespace brume
