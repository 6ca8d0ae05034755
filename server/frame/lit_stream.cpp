#include "server/frame/lit_stream.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/inputs/multiple_block.h"

namespace brume {
namespace {

using Millis = std::chrono::duration<float, std::milli>;

constexpr uint32_t kMostParticles = 16'384; // of a message; larger media are merged to so many
constexpr uint32_t kMostMerged = 262'144;   // that are merged in time
constexpr uint32_t kGroupsLast = 256;       // messages
constexpr size_t kMostObjects = 16;         // that a viewer's shaders look through for each pixel

float millisBetween(Clock::time_point from, Clock::time_point to) { return Millis(to - from).count(); }

} // namespace

std::string whyNotDrawable(const ShownScene& shown) {
    const SceneNow& now = shown.simulation.now();
    const SceneFeatures features = featuresOf(*shown.scene, now);
    if (now.medium.model != kSumMedium) return fmt::format("its medium.model is \"{}\"", now.medium.model);
    if (features.fog) return "it has fog";
    if (features.local_lights) return "it has points or spots";
    if (features.meshes) return "it has meshes";
    if (features.glass) return "it has glass";
    if (scatteringOf(now.render) == gpu::kScatteringOctaves) return "its light scatters as octaves";
    if (shown.scene->sky.lights) return "the sky lights it";
    if (features.emission && scatteringOf(now.render) == gpu::kScatteringPropagation)
        return "light that it emits scatters in it";
    const size_t objects =
        now.lists.planes.size() + now.lists.boxes.size() + now.lists.spheres.size() + now.lists.laid_out;
    if (objects > kMostObjects) return fmt::format("it has more than {} objects", kMostObjects);
    if (shown.simulation.liveCount() > kMostMerged) return fmt::format("it has more than {} particles", kMostMerged);
    return {};
}

LitStream::LitStream(const gpu::Device& device, Metrics& metrics, Measuring& measuring, double most_rate)
    : metrics_(metrics), measuring_(measuring), most_rate_(most_rate), submission_(device, "light") {}

// Messages a second that keep within the rate of bytes: all of `hz`, or a half, a quarter, an eighth.
double LitStream::hzWithin(double hz) const {
    double bytes = 0, best = 0; // bytes a second of the upper layers
    for (uint32_t layer = lit::kLayers; layer-- > 0;) {
        const double of_layer = hz / double(layer + 1 < lit::kLayers ? 2u << layer : 1u << layer);
        bytes += of_layer * sizes_[layer];
        if (best > 0 && bytes > most_rate_) break;
        best = hz / double(1u << layer);
    }
    return best;
}

// Messages a second: half of the ticks, unless somebody wants all and may have more than that.
double LitStream::hzFor(std::span<const std::shared_ptr<Viewer>> viewers) const {
    constexpr double kAll = 1 / kTickSeconds;
    uint32_t most = 0;
    for (const auto& viewer : viewers) most = std::max(most, viewer->drawHz());
    return most == 0 ? 0 : most > kAll / 2 && hzWithin(kAll) > kAll / 2 ? kAll : kAll / 2;
}

bool LitStream::isDue(std::span<const std::shared_ptr<Viewer>> viewers, const ShownScene& shown,
                      Clock::time_point now) const {
    if (packing_) return false;
    const double hz = hzFor(viewers);
    if (hz == 0 || now - taken_ < std::chrono::duration<double>(1 / hz - 0.5 * kTickSeconds)) return false;
    if (version_ != shown.version) return true;
    return std::ranges::any_of(viewers, [&](const auto& one) { return one->lags(shown.version, now); });
}

void LitStream::submit(Renderer& renderer, const ShownScene& shown, const RenderSettings& settings,
                       std::span<const std::shared_ptr<Viewer>> viewers, Clock::time_point now) {
    // A scene at rest is told to those who have not its last state.
    const bool rests = version_ == shown.version;
    const double hz = hzFor(viewers), most_hz = rests ? std::numeric_limits<double>::infinity() : hzWithin(hz);
    taken_ = now;
    jobs_.clear();
    whole_ = false;
    for (const auto& viewer : viewers)
        if (const auto due = viewer->takeLit(number_ + 1, hz, most_hz, shown.version, now)) {
            whole_ = whole_ || due->whole;
            jobs_.push_back({viewer, *due, measuring_.known(viewer->id(), kDrawnByViewer)});
        }
    drawers_.clear();
    for (const Job& job : jobs_) drawers_.push_back({job.viewer->id(), &job.due.request});
    measured_ = measuring_.beginLit(drawers_, now);
    // A message that nobody takes is made all the same: others are differences to it.
    ++number_;
    version_ = shown.version;
    next_ = std::make_shared<LitTick>();
    next_->tick = shown.simulation.tick();
    next_->state_hash = shown.simulation.stateHash();
    next_->number = number_;
    next_->predicted = measuring_.knownOfDrawers();
    next_->exposure = shown.simulation.now().render.exposure;
    next_->filmic = settings.tone_map == "filmic";
    on_device_ = true;
    renderer.submitLight(submission_, shown.simulation, settings, grouped(shown));
}

// The groups of a large medium, which last while its particles are the same ones; of others nothing. Sets their ids.
std::span<const gpu::Particle> LitStream::grouped(const ShownScene& shown) {
    const Simulation& simulation = shown.simulation;
    const uint64_t first = simulation.firstId();
    if (simulation.liveCount() <= kMostParticles) {
        groups_.clear();
        first_ = first;
        return {};
    }
    particles_.resize(simulation.liveCount());
    simulation.write(particles_);
    if (groups_.particles() != particles_.size() || number_ - grouped_at_ >= kGroupsLast || first != 0) {
        LastingGroups next;
        next.build(particles_, kMostParticles);
        grouped_at_ = number_;
        if (!(next == groups_)) groups_ = std::move(next), ++groupings_;
    }
    first_ = groupings_ << 32; // other groups are other particles
    groups_.merge(particles_, simulation.now().medium.falloff, merged_);
    return merged_;
}

void LitStream::drop() {
    for (const Job& job : jobs_) job.viewer->abandon(job.due.frame_id);
    jobs_.clear();
    if (measured_) measuring_.giveLit(std::move(measured_), nullptr);
    on_device_ = false;
}

void LitStream::wait(std::chrono::nanoseconds longest, EncodeWorkers& workers) {
    if (!submission_.commands.wait(uint64_t(longest.count()))) return;
    on_device_ = false;
    done_ = Clock::now();
    float ms = 0;
    for (const gpu::PassSample& sample : submission_.commands.readTimes()) ms += sample.ms;
    metrics_.drawn(ms, 0);
    packing_ = true;
    workers.give([this](JpegEncoder&) {
        pack();
        packing_ = false;
    });
}

// On a worker's thread, where nothing may be thrown: a message that cannot be made is lost, and so are those that refer
// to it.
void LitStream::pack() noexcept {
    try {
        const Submission::Fits& fits = submission_.fits();
        LitRows made = litRows(fits, first_);
        LitTick& lit = *next_;
        lit.first = first_;
        lit.count = made.rows.count;
        lit.origin = made.origin, lit.step = made.step;
        lit.scene = fits.tick;
        lit.objects = fits.objects;
        for (const Hue& hue : fits.hues) lit.hues.push_back({uint8_t(hue.channels), hue.particles});
        if (measured_) {
            auto drawn = std::make_shared<lit::Medium>(litMedium(made, fits));
            drawn->ambient = glm::dvec3(0);
            measuring_.giveLit(std::move(measured_), std::move(drawn));
        }
        const uint32_t reference = lit::referenceOf(lit.number);
        const auto& held = rows_[reference == 0 ? 0 : lit::layerOf(reference)];
        const bool has = reference > 0 && held.first == reference;
        lit.reference = has ? reference : 0;
        lit.changes = packer_.pack(made.rows, has ? &held.second : nullptr);
        if (has && whole_) lit.whole = packer_.pack(made.rows, nullptr);
        constexpr double kNewest = 0.2;
        std::atomic<double>& size = sizes_[lit::layerOf(lit.number)];
        size = size + kNewest * (double(lit.changes.bytes.size()) - size);
        rows_[lit::layerOf(lit.number)] = {lit.number, std::move(made.rows)};
        uint64_t bytes = 0;
        for (const auto& [number, rows] : rows_)
            for (const auto& column : rows.columns) bytes += column.capacity() * sizeof(uint16_t);
        bytes_ = bytes;
        const Clock::time_point packed = Clock::now();
        for (const Job& job : jobs_) {
            auto frame = std::make_shared<EncodedFrame>();
            frame->id = job.due.frame_id;
            frame->tick = lit.tick;
            frame->state_hash = lit.state_hash;
            frame->request = job.due.request;
            frame->repeats = true; // it answers no pose
            frame->render_ms = millisBetween(taken_, done_);
            frame->encode_ms = millisBetween(done_, packed);
            frame->encoded = packed;
            frame->measured = job.measured;
            frame->lit = next_;
            metrics_.rendered(*frame);
            job.viewer->deliver(std::move(frame));
        }
    } catch (const std::exception& error) {
        spdlog::error("the lit medium of a tick is lost: {}", error.what());
        for (const Job& job : jobs_) job.viewer->abandon(job.due.frame_id);
    }
    if (measured_) measuring_.giveLit(std::move(measured_), nullptr);
    jobs_.clear();
    next_.reset();
}

} // namespace brume
