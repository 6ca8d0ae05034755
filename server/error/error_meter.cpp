#include "server/error/error_meter.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <new>
#include <optional>
#include <random>
#include <tuple>

#include <sys/resource.h>
#include <unistd.h>

#include "common/random.h"
#include "server/error/accuracy.h"
#include "server/inputs/eye_request.h"
#include "tools/reference/camera.h"
#include "tools/reference/pixel.h"

namespace brume {
namespace {

constexpr double kMostCredit = 0.3;  // s of CPU time that may be taken at once
constexpr double kMostOfJob = 0.05;  // s of it after which no pixel of a job is begun
constexpr double kTolerance = 1e-4;  // the reference's relative tolerance, a twentieth of errors of 0.2 %
constexpr double kShows = 0.999;     // transmittance below which a pixel shows the medium
constexpr float kEmpty = 0.99999f;   // transmittance above which a pixel was drawn without the medium
constexpr uint64_t kLookAnyway = 16; // one in so many pixels without medium is traced, too
constexpr size_t kNewest = 256;      // pixels of ViewError::newest
constexpr uint32_t kParts = 16;      // parts of the rectangle, across and down; each gives one pixel
// Below that of pictures. The lowest of all would keep the process from ending while others have work.
constexpr int kPriority = 10;

double threadSeconds() {
    timespec now{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

reference::World worldOf(const MeterJob& job) {
    const SceneNow& now = job.now;
    Scene scene = *job.scene;
    setObjects(scene, now.lists);
    reference::World world =
        reference::worldOf(scene, job.particles, {now.medium, now.light, now.lists.lights, now.lists.fogs, job.axes});
    // Sky, ambient light and haze would dilute the error. What was drawn has them in it.
    if (!job.drawn) world.sky_zenith = world.sky_horizon = world.ambient = glm::dvec3(0), world.haze = 0;
    return world;
}

// What is behind the medium is the reference's in both: only the medium's error counts. A drawn pixel has its
// background in it; there the medium's light alone is compared.
PixelError comparedTo(const reference::RayResult& truth, glm::vec4 value, bool drawn) {
    const glm::dvec3 seen(value), behind = truth.background;
    if (drawn) return {glm::vec3(seen - double(value.a) * behind), glm::vec3(truth.scattered)};
    return {glm::vec3(seen + double(value.a) * behind), glm::vec3(truth.total())};
}

// Of a pixel's middle. The error is relative to the reference.
gpu::ErrorDisc discOf(const PixelError& pixel, glm::uvec2 at, glm::uvec2 size) {
    const float reference = std::max(glm::length(pixel.reference), 1e-9f);
    return {(glm::vec2(at) + 0.5f) / glm::vec2(size), glm::distance(pixel.value, pixel.reference) / reference};
}

bool isSame(const Pose& a, const Pose& b) {
    return a.position == b.position && a.orientation == b.orientation && a.fov_y == b.fov_y && a.frustum == b.frustum;
}

// False: the rays through the pixel's corners and centre meet the same object, shadows and sheets, so that no edge
// crosses the pixel. It costs nothing beside a traced ray. `corner`: the pixel's, upper left.
bool mayHaveEdge(const reference::Stage& stage, const reference::Camera& camera, glm::dvec2 corner) {
    if (!reference::hasEdges(stage.world)) return false;
    std::optional<std::tuple<int, size_t, size_t>> first; // object, shadows, sheets of glass
    std::vector<double> shadows;
    std::vector<reference::SheetHit> sheets;
    for (const glm::dvec2 at : {glm::dvec2(0.5, 0.5), {0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        reference::Ray ray = reference::rayThrough(camera, corner.x + at.x, corner.y + at.y);
        const reference::Hit hit = stage.lighting.obstacles().nearest(ray);
        ray.end = std::min(ray.end, hit.t);
        shadows.clear();
        stage.lighting.edges(ray, shadows);
        const auto inside = std::ranges::count_if(shadows, [&](double t) { return t > ray.begin && t < ray.end; });
        reference::sheetsOn(stage.world, ray, sheets);
        const std::tuple met(hit.object, size_t(inside), sheets.size());
        if (first && met != *first) return true;
        first = met;
    }
    return false;
}

// What a viewer draws by itself at a pixel's middle.
glm::vec4 drawnBy(const lit::Medium& medium, const reference::Stage& stage, const reference::Camera& camera,
                  glm::dvec2 corner) {
    const reference::Ray ray = reference::rayThrough(camera, corner.x + 0.5, corner.y + 0.5);
    const double far = std::min(ray.end, stage.lighting.obstacles().nearest(ray).t);
    const lit::Seen seen = lit::along(medium, ray.origin, ray.direction, ray.begin, far);
    return {glm::vec3(seen.radiance), float(seen.transmittance.x + seen.transmittance.y + seen.transmittance.z) / 3};
}

} // namespace

bool DrawnWith::operator==(const DrawnWith& other) const {
    const RenderSettings &a = settings, &b = other.settings;
    const MethodSettings &own_of_a = a, &own_of_b = b;
    return version == other.version && a.method == b.method && a.rate == b.rate && a.slabs == b.slabs &&
           a.shading == b.shading && a.shadow_error == b.shadow_error && own_of_a == own_of_b;
}

ErrorMeter::ErrorMeter(double share, Time (*clock)()) : share_(share), clock_(clock), credit_s_(kMostCredit) {
    if (share > 0) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

ErrorMeter::~ErrorMeter() = default;

std::unique_ptr<MeterJob> ErrorMeter::begin(std::span<const uint32_t> viewers, Time now) {
    if (share_ <= 0 || viewers.empty()) return nullptr;
    const std::scoped_lock lock(mutex_);
    if (credited_ != Time{})
        credit_s_ = std::min(credit_s_ + share_ * std::chrono::duration<double>(now - credited_).count(), kMostCredit);
    credited_ = now;
    if (busy_ || credit_s_ <= 0) return nullptr;
    busy_ = true;
    const auto when = [&](uint32_t viewer) {
        const auto last = last_.find(viewer);
        return last == last_.end() ? 0 : last->second;
    };
    const uint32_t viewer = *std::ranges::min_element(viewers, {}, when);
    last_[viewer] = ++jobs_;
    std::unique_ptr<MeterJob> job = free_ ? std::move(free_) : std::make_unique<MeterJob>();
    job->viewer = viewer;
    job->epoch = epoch_;
    job->number = jobs_;
    return job;
}

void ErrorMeter::give(std::unique_ptr<MeterJob> job) {
    const std::scoped_lock lock(mutex_);
    waiting_ = std::move(job);
    given_.notify_one();
}

void ErrorMeter::drop(std::unique_ptr<MeterJob> job) {
    const std::scoped_lock lock(mutex_);
    free_ = std::move(job);
    busy_ = false;
}

void ErrorMeter::stay(std::span<const uint32_t> viewers) {
    const std::scoped_lock lock(mutex_);
    const auto left = [&](uint32_t viewer) { return !std::ranges::binary_search(viewers, viewer); };
    std::erase_if(last_, [&](const auto& one) { return left(one.first); });
    std::erase_if(windows_, [&](const auto& one) { return left(std::get<0>(one.first)); });
    std::erase_if(shown_, [&](const auto& one) { return left(one.first); });
}

void ErrorMeter::forget() {
    const std::scoped_lock lock(mutex_);
    ++epoch_;
    windows_.clear();
    shown_.clear();
    last_.clear();
}

std::vector<ViewError> ErrorMeter::errors(Time now) const {
    const std::scoped_lock lock(mutex_);
    std::vector<ViewError> all;
    Time last{};
    for (const auto& [of, window] : windows_) {
        const auto& [viewer, method, accuracy] = of;
        if (now - window.last() > ErrorWindow::kKept) continue;
        const bool same = !all.empty() && all.back().viewer == viewer && all.back().method == method;
        if (same && window.last() < last) continue;
        if (same) all.pop_back();
        last = window.last();
        all.push_back({viewer, method, window.estimate(now), window.estimate(now, kNewest)});
    }
    return all;
}

void ErrorMeter::shown(uint32_t viewer, const Pose& pose, const DrawnWith& with, Time now,
                       std::vector<gpu::ErrorDisc>& out) const {
    const std::scoped_lock lock(mutex_);
    const auto of = shown_.find(viewer);
    if (of == shown_.end() || !isSame(of->second.pose, pose)) return;
    const DrawnWith* last = nullptr; // of the pixel before: pixels of one picture are compared once
    bool same = false;
    for (const Shown::Pixel& pixel : of->second.pixels) {
        if (pixel.with.get() != last) last = pixel.with.get(), same = *last == with;
        if (same && now - pixel.at <= ErrorWindow::kKept) out.push_back(pixel.disc);
    }
}

// Precondition: mutex_ is held.
void ErrorMeter::keep(const MeterJob& job, std::span<const gpu::ErrorDisc> discs, Time now) {
    Shown& shown = shown_[job.viewer];
    if (!isSame(shown.pose, job.pose)) shown = {job.pose, {}};
    const auto with = std::make_shared<const DrawnWith>(job.with);
    for (const gpu::ErrorDisc& disc : discs) shown.pixels.push_back({disc, now, with});
    while (shown.pixels.size() > gpu::kMostErrorDiscs) shown.pixels.pop_front();
}

void ErrorMeter::run(const std::stop_token& stop) {
    [[maybe_unused]] const int set = ::setpriority(PRIO_PROCESS, id_t(::gettid()), kPriority);
    for (;;) {
        std::unique_ptr<MeterJob> job;
        {
            std::unique_lock lock(mutex_);
            if (!given_.wait(lock, stop, [&] { return waiting_ != nullptr; })) return;
            job = std::move(waiting_);
        }
        const double began = threadSeconds();
        try {
            measure(*job, stop);
        } catch (const std::bad_alloc&) { // where memory is short nothing is measured
        }
        const std::scoped_lock lock(mutex_);
        credit_s_ -= threadSeconds() - began;
        free_ = std::move(job);
        busy_ = false;
    }
}

void ErrorMeter::measure(const MeterJob& job, const std::stop_token& stop) {
    const reference::World world = worldOf(job);
    const reference::Stage stage(world, {.tolerance = kTolerance, .light_cells = 1});
    reference::RayTracer tracer(stage);
    const bool structure = reference::hasStructure(world);
    const reference::Camera camera = reference::perspective(job.pose, int(job.size.x), int(job.size.y), kNearDepth);
    std::vector<uint32_t> order;
    for (uint32_t i = 0; i < job.pixels.size(); ++i)
        if (job.lit || job.values[i].a <= kEmpty || mix64(job.number + i) % kLookAnyway == 0) order.push_back(i);
    std::ranges::shuffle(order, std::minstd_rand(uint32_t(job.number)));
    const double until = threadSeconds() + kMostOfJob;
    std::vector<PixelError> found;
    std::vector<gpu::ErrorDisc> discs;
    for (const uint32_t i : order) {
        if (stop.stop_requested() || threadSeconds() > until) break;
        const glm::dvec2 corner(job.pixels[i]);
        const auto at = [&](double x, double y, bool even) {
            reference::Ray ray = reference::rayThrough(camera, corner.x + x, corner.y + y);
            ray.even = even;
            return tracer.trace(ray);
        };
        const bool edges = mayHaveEdge(stage, camera, corner);
        const reference::PixelResult pixel = reference::pixelOf(at, edges, structure, kShows);
        if (pixel.edge || pixel.transmittance >= kShows) continue;
        const glm::vec4 value = job.lit ? drawnBy(*job.lit, stage, camera, corner) : job.values[i];
        found.push_back(comparedTo(pixel.centre, value, job.drawn));
        if (job.keeps) discs.push_back(discOf(found.back(), job.pixels[i], job.size));
    }
    const std::scoped_lock lock(mutex_);
    if (found.empty() || job.epoch != epoch_ || !last_.contains(job.viewer)) return;
    const int accuracy = job.law > 0 ? accuracyOf(job.law) : 0;
    const Time now = clock_();
    windows_[{job.viewer, job.with.settings.method, accuracy}].add(found, job.law, now);
    if (job.keeps) keep(job, discs, now);
    std::erase_if(windows_, [&](const auto& one) { return now - one.second.last() > ErrorWindow::kKept; });
}

std::vector<glm::uvec2> pixelsOf(const Pose& pose, glm::uvec2 size, glm::vec3 lo, glm::vec3 hi, uint64_t seed) {
    const Frustum frustum = frustumOf(pose, size.x, size.y);
    const glm::quat view_from_world = glm::conjugate(pose.orientation);
    glm::vec2 from(1), to(0); // parts of the picture's sides
    bool seen = false, beside = false;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 at =
            view_from_world * (glm::mix(lo, hi, glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2)) - pose.position);
        if (at.z >= -kNearDepth) {
            beside = true; // no bound: it may be anywhere in the picture
            continue;
        }
        const glm::vec2 part((at.x / -at.z + frustum.left) / (frustum.left + frustum.right),
                             (frustum.up - at.y / -at.z) / (frustum.up + frustum.down));
        from = glm::min(from, part), to = glm::max(to, part);
        seen = true;
    }
    if (!seen) return {};
    if (beside) from = glm::vec2(0), to = glm::vec2(1);
    const glm::vec2 first = glm::clamp(from, 0.0f, 1.0f) * glm::vec2(size),
                    sides = glm::clamp(to, 0.0f, 1.0f) * glm::vec2(size) - first;
    std::vector<glm::uvec2> pixels;
    if (!(sides.x >= 1 && sides.y >= 1)) return pixels;
    Random random(seed);
    for (uint32_t y = 0; y < kParts; ++y)
        for (uint32_t x = 0; x < kParts; ++x) {
            const float right = random.uniform(), down = random.uniform();
            const glm::vec2 at = first + sides * (glm::vec2(float(x) + right, float(y) + down) / float(kParts));
            pixels.push_back(glm::min(glm::uvec2(at), size - 1u));
        }
    return pixels;
}

} // namespace brume
