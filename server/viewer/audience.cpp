#include "server/viewer/audience.h"

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>

namespace brume {
namespace {

constexpr size_t kMostLost = 1024, kMostOfOne = 64; // viewers whose connection broke: of all, of one owner
constexpr std::chrono::seconds kComesBackWithin{60};

// A secret key: 128 random bits in hexadecimal, of a generator made for secrets.
std::string newKey() {
    std::array<unsigned char, 16> bits;
    if (RAND_bytes(bits.data(), int(bits.size())) != 1) throw std::runtime_error("there are no random bytes for a key");
    return fmt::format("{:02x}", fmt::join(bits, ""));
}

// True if they are equal. The time that it takes says nothing of where they differ.
bool sameKey(const std::string& a, const std::string& b) {
    return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
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
    std::vector<std::string> choices(setting.choices.begin(), setting.choices.end());
    if (setting.in_list) std::erase(choices, kDirectional); // stands in no list
    return choices;
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

void Audience::prepare(const std::string& name) {
    const std::scoped_lock lock(mutex_);
    preparing_ = name;
    ++revision_;
}

std::string Audience::preparing() const {
    const std::scoped_lock lock(mutex_);
    return preparing_;
}

void Audience::setMaxViewers(uint32_t max_viewers, uint32_t per_owner, uint32_t drawing) {
    const std::scoped_lock lock(mutex_);
    max_viewers_ = max_viewers;
    max_per_owner_ = per_owner;
    max_drawing_ = drawing;
}

uint32_t Audience::placesFor(bool is_operator) const {
    return max_viewers_ - (keeps_place_ && !is_operator && max_viewers_ > 1);
}

uint32_t Audience::places() const {
    const std::scoped_lock lock(mutex_);
    return std::min<uint32_t>(placesFor(false), time_for_);
}

uint32_t Audience::countPictures() const {
    return uint32_t(std::ranges::count_if(viewers_, [](const auto& one) { return !one->draws(); }));
}

uint32_t Audience::withPictures() const {
    const std::scoped_lock lock(mutex_);
    return countPictures();
}

const char* Audience::whyFullOfDrawing(const Newcomer& newcomer) const {
    if (viewers_.size() - countPictures() >= max_drawing_) return "every place to draw is taken";
    const auto own = std::ranges::count_if(
        viewers_, [&](const auto& one) { return one->draws() && one->owner() == newcomer.owner; });
    if (!newcomer.owner.empty() && size_t(own) >= (3 * size_t{max_drawing_} + 3) / 4)
        return "your address or token has as many places to draw as one may have";
    return nullptr;
}

const char* Audience::whyFull(const Newcomer& newcomer) const {
    if (newcomer.draws && max_drawing_ > 0 && report_->not_drawable.empty()) return whyFullOfDrawing(newcomer);
    const size_t places = placesFor(newcomer.is_operator), taken = countPictures();
    if (taken >= places) return taken >= max_viewers_ ? "every place is taken" : "the last place is kept for operators";
    if (taken >= time_for_) return "there is no time to draw for one more viewer";
    const auto own = std::ranges::count_if(
        viewers_, [&](const auto& one) { return !one->draws() && one->owner() == newcomer.owner; });
    if (!newcomer.owner.empty() && uint32_t(own) >= max_per_owner_)
        return "your address or token has as many places as one may have";
    return nullptr;
}

Audience::Admission Audience::join(std::function<void()> notify, const Newcomer& newcomer) {
    const std::scoped_lock lock(mutex_);
    if (const char* const refusal = whyFull(newcomer)) return {nullptr, refusal};
    const uint32_t window =
        newcomer.max_in_flight == 0 ? max_in_flight_ : std::min(newcomer.max_in_flight, max_in_flight_);
    PacingOptions pacing;
    pacing.most_frames = window;
    pacing.least_frames = std::min(pacing.least_frames, window);
    const auto known = lostOf(newcomer);
    const bool back = known != lost_.end();
    auto viewer = std::make_shared<Viewer>(back ? known->id : next_id_++, pacing, std::move(notify));
    viewer->known(newKey(), newcomer.owner, newcomer.token, newcomer.draws);
    if (back) {
        viewer->resume(known->pose);
        lost_.erase(known); // a key can be used once
    }
    viewers_.push_back(viewer);
    if (newcomer.is_person) people_.join(viewer, newcomer.token, newcomer.role);
    ++revision_;
    return {std::move(viewer)};
}

void Audience::leave(const std::shared_ptr<Viewer>& viewer, bool lost) {
    {
        const std::scoped_lock lock(mutex_);
        if (std::erase(viewers_, viewer) > 0) ++revision_;
        if (lost) remember(viewer);
    }
    people_.leave(viewer->id());
    viewer->close(); // without the lock: close() waits for the viewer's notify, which may call this class
}

// The viewer that may be resumed with this key and this token; the end if there is none. Looks at all of them.
std::vector<Audience::Lost>::iterator Audience::lostOf(const Newcomer& newcomer) {
    auto found = lost_.end();
    for (auto one = lost_.begin(); one != lost_.end(); ++one)
        if (sameKey(one->key, newcomer.key) && one->token == newcomer.token && one->until > Clock::now()) found = one;
    return found;
}

// Keeps what a lost viewer resumes with. Where one owner has too many, its oldest goes. Where there are too many of
// all, the oldest of the owner with the most goes: one who loses thousands pushes out its own.
void Audience::remember(const std::shared_ptr<Viewer>& viewer) {
    const auto now = Clock::now();
    std::erase_if(lost_, [&](const Lost& one) { return one.until <= now; });
    std::map<std::string, size_t> of_owner;
    for (const Lost& one : lost_) ++of_owner[one.owner];
    const auto forget = [&](const std::string& owner) { lost_.erase(std::ranges::find(lost_, owner, &Lost::owner)); };
    if (of_owner[viewer->owner()] >= kMostOfOne)
        forget(viewer->owner());
    else if (lost_.size() >= kMostLost)
        forget(std::ranges::max_element(of_owner, {}, [](const auto& one) { return one.second; })->first);
    lost_.push_back(
        {viewer->key(), viewer->owner(), viewer->token(), viewer->id(), viewer->pose(), now + kComesBackWithin});
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
