#include "server/viewer/audience.h"

#include <algorithm>
#include <random>

#include <fmt/format.h>

namespace brume {
namespace {

constexpr size_t kMostLost = 1024;
constexpr std::chrono::seconds kComesBackWithin{60};

// A secret key: 128 random bits in hexadecimal.
std::string newKey() {
    std::random_device random;
    std::string key;
    for (int i = 0; i < 4; ++i) key += fmt::format("{:08x}", random());
    return key;
}

} // namespace

std::shared_ptr<const SceneFacts> sceneFacts(const Scene& scene, std::vector<std::string> others) {
    auto facts = std::make_shared<SceneFacts>();
    facts->scene = scene;
    facts->others = std::move(others);
    Light light = sunOf(scene);
    Scene& own = facts->scene;
    const SceneParts parts{
        .medium = &own.medium, .simulation = &own.simulation, .light = &light, .sky = &own.sky, .render = &own.render};
    for (const SceneSetting* setting : liveSettings()) facts->starts.push_back(valueOf(*setting, parts));
    return facts;
}

std::vector<std::string> ServerFacts::choicesOf(const SceneSetting& setting) const {
    if (setting.path == "render.method") return methods;
    return {setting.choices.begin(), setting.choices.end()};
}

Audience::Audience(ServerFacts facts, std::shared_ptr<const SceneFacts> scene, uint32_t max_viewers,
                   uint32_t max_in_flight)
    : facts_(std::move(facts)), max_viewers_(max_viewers), max_in_flight_(std::max(max_in_flight, 1u)),
      scene_(std::move(scene)), report_(std::make_shared<SceneReport>()) {}

std::shared_ptr<const SceneFacts> Audience::scene() const {
    const std::scoped_lock lock(mutex_);
    return scene_;
}

void Audience::setScene(std::shared_ptr<const SceneFacts> scene) {
    const std::scoped_lock lock(mutex_);
    scene_.swap(scene); // the old one is freed by the caller's thread, after the lock
    ++revision_;
}

void Audience::setMaxViewers(uint32_t max_viewers) {
    const std::scoped_lock lock(mutex_);
    max_viewers_ = max_viewers;
}

std::shared_ptr<Viewer> Audience::join(std::function<void()> notify, uint32_t max_in_flight, const std::string& key) {
    const std::scoped_lock lock(mutex_);
    if (viewers_.size() >= max_viewers_ || !hasTime()) return nullptr;
    const uint32_t window = max_in_flight == 0 ? max_in_flight_ : std::min(max_in_flight, max_in_flight_);
    PacingOptions pacing;
    pacing.most_frames = window;
    pacing.least_frames = std::min(pacing.least_frames, window);
    const auto known = key.empty() ? lost_.end() : lost_.find(key);
    const bool back = known != lost_.end() && known->second.until > Clock::now();
    viewers_.push_back(std::make_shared<Viewer>(back ? known->second.id : next_id_++, pacing, std::move(notify)));
    viewers_.back()->known(newKey());
    if (back) viewers_.back()->resume(known->second.pose);
    if (known != lost_.end()) lost_.erase(known); // a key can be used once
    ++revision_;
    return viewers_.back();
}

bool Audience::hasTime() const {
    const auto count = float(viewers_.size());
    return count == 0 || frame_ms_ * (count + 1) / count <= most_frame_ms_;
}

const char* Audience::whyFull() const {
    const std::scoped_lock lock(mutex_);
    return viewers_.size() >= max_viewers_ ? "every place is taken" : "there is no time to draw for one more viewer";
}

void Audience::frameTook(float ms) {
    const std::scoped_lock lock(mutex_);
    frame_ms_ = frame_ms_ == 0 ? ms : frame_ms_ + 0.1f * (ms - frame_ms_);
}

void Audience::leave(const std::shared_ptr<Viewer>& viewer, bool lost) {
    {
        const std::scoped_lock lock(mutex_);
        if (std::erase(viewers_, viewer) > 0) ++revision_;
        if (viewers_.empty()) frame_ms_ = 0;
        const auto now = Clock::now();
        std::erase_if(lost_, [&](const auto& one) { return one.second.until <= now; });
        if (lost && lost_.size() < kMostLost)
            lost_[viewer->key()] = {viewer->id(), viewer->pose(), now + kComesBackWithin};
    }
    viewer->close(); // without the lock: close() waits for the viewer's notify, which may call this class
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
    if (report_->settings_version != report->settings_version) ++revision_;
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
