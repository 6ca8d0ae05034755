#include "server/viewer/audience.h"

#include <algorithm>

namespace brume {
namespace {

// True when a viewer's panel would show something else. What moves by itself (tick, particles, a turning light) waits for the
// report of the second.
bool settingsDiffer(const SceneReport& a, const SceneReport& b) {
    const bool turning = a.light.rotate != 0 && a.light.rotate == b.light.rotate;
    return a.paused != b.paused || (!turning && a.light.to_light != b.light.to_light) ||
           a.light.irradiance != b.light.irradiance || a.light.rotate != b.light.rotate ||
           a.medium.extinction != b.medium.extinction || a.medium.falloff != b.medium.falloff ||
           a.medium.anisotropy != b.medium.anisotropy || a.medium.asymmetry != b.medium.asymmetry ||
           a.medium.albedo != b.medium.albedo || a.render.method != b.render.method ||
           a.render.quadrature != b.render.quadrature || a.render.steps != b.render.steps ||
           a.render.exposure != b.render.exposure;
}

} // namespace

Audience::Audience(SceneFacts facts, uint32_t max_viewers, uint32_t max_in_flight)
    : facts_(std::move(facts)), max_viewers_(max_viewers), max_in_flight_(std::max(max_in_flight, 1u)),
      report_(std::make_shared<SceneReport>()) {}

void Audience::setMaxViewers(uint32_t max_viewers) {
    const std::scoped_lock lock(mutex_);
    max_viewers_ = max_viewers;
}

std::shared_ptr<Viewer> Audience::join(std::function<void()> notify, uint32_t max_in_flight) {
    const std::scoped_lock lock(mutex_);
    if (viewers_.size() >= max_viewers_) return nullptr;
    const uint32_t window = max_in_flight == 0 ? max_in_flight_ : std::min(max_in_flight, max_in_flight_);
    viewers_.push_back(std::make_shared<Viewer>(next_id_++, window, std::move(notify)));
    ++revision_;
    return viewers_.back();
}

void Audience::leave(const std::shared_ptr<Viewer>& viewer) {
    {
        const std::scoped_lock lock(mutex_);
        if (std::erase(viewers_, viewer) > 0) ++revision_;
    }
    viewer->close(); // outside the lock: it waits for the viewer's notify, which may ask us
}

uint32_t Audience::size() const {
    const std::scoped_lock lock(mutex_);
    return uint32_t(viewers_.size());
}

void Audience::list(std::vector<std::shared_ptr<Viewer>>& out) const {
    const std::scoped_lock lock(mutex_);
    out.assign(viewers_.begin(), viewers_.end());
}

void Audience::publish(std::shared_ptr<const SceneReport> report) {
    const std::scoped_lock lock(mutex_);
    if (settingsDiffer(*report_, *report)) ++revision_;
    report_.swap(report); // the old one is freed by the caller's thread, after the lock
}

std::shared_ptr<const SceneReport> Audience::report() const {
    const std::scoped_lock lock(mutex_);
    return report_;
}

uint64_t Audience::revision() const {
    const std::scoped_lock lock(mutex_);
    return revision_;
}

} // namespace brume
