#include "server/frame/drawing.h"

#include <algorithm>
#include <new>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/compile/progress.h"
#include "server/compile/warm_up.h"
#include "server/plan/memory.h"

namespace brume {
namespace {

using Millis = std::chrono::duration<float, std::milli>;

constexpr auto kLookAtDeferred = std::chrono::seconds(1); // for those who have waited long enough
// That a snapshot waits for its shaders. Then it is drawn another way.
constexpr auto kLongestDeferral = std::chrono::seconds(10);
// The most that first pictures take when the driver has their shaders in its cache.
constexpr std::chrono::milliseconds kKnown{700};

double pixelsOf(std::span<const PlanView> views) {
    double pixels = 0;
    for (const PlanView& view : views) pixels += view.weight * view.width * view.height;
    return std::max(pixels, 1.0);
}

// Throws gpu::Error when these pictures need more than `target` bytes for the largest, or `planes` for all.
void checkPictures(std::span<const EyeRequest> eyes, bool full, const SceneFeatures& features, uint64_t target,
                   uint64_t planes) {
    const uint64_t of_pixel = Renderer::mostBytesOfPixel(features);
    for (const EyeRequest& eye : eyes)
        if (of_pixel * eye.width * eye.height > target)
            throw gpu::Error(
                fmt::format("a picture of {} x {} takes more than half of --picture-memory: ask for smaller "
                            "ones or allow more",
                            eye.width, eye.height));
    uint64_t bytes = 0;
    for (const EyeRequest& eye : eyes)
        bytes +=
            PlaneLayout{eye.width, eye.height, full}.bytes() + depthLayerBytes(eye.width, eye.height, eye.depth_layers);
    if (bytes > planes)
        throw gpu::Error(
            fmt::format("pictures of {} MiB together, --picture-memory and the device allow {} MiB: ask for "
                        "smaller ones or allow more",
                        bytes >> 20, planes >> 20));
}

} // namespace

Drawing::Drawing(ShownScene& shown, const gpu::Device& device, Audience& audience, Metrics& metrics,
                 const FrameOptions& options)
    : shown_(shown), device_(device), audience_(audience), metrics_(metrics), picture_memory_(options.picture_memory),
      most_frame_ms_(options.most_frame_ms), frame_ms_(options.frame_ms),
      pipelines_(device.pipelines(), [this](const std::string& text) { pipelineMade(text); }),
      renderer_(std::in_place, device, *shown.scene, boundedCapacity(*shown.scene, shown.simulation, options.memory)),
      planning_(shown, ways_, options), measuring_(shown, device, options), refinement_(options.refine_moving),
      lit_(device, metrics, measuring_, 1000 * options.lit_rate), encoding_(metrics) {
    ways_.setAll(!options.compiled_behind);
    ways_.clear(shown_.drawn);
    for (unsigned i = 0; i < std::max(options.batches, 2u); ++i) batches_.push_back(std::make_unique<Batch>(device));
    warmUp();
    shows_ = true;
}

void Drawing::setBudget(double frame_ms, double law_factor) {
    frame_ms_ = frame_ms;
    planning_.planner().setFrameBudget(frame_ms);
    planning_.planner().setLawFactor(law_factor);
}

// Those that were compiled before, here or in a process ahead, the driver has in its cache. What other threads make
// keeps no picture waiting.
void Drawing::pipelineMade(const std::string& text) {
    const bool news = ways_.addPipeline(text);
    if (!shows_) return;
    if (std::this_thread::get_id() != submitter_.load()) return spdlog::debug("a pipeline beside pictures: {}", text);
    ++pipelines_made_;
    if (!news) return spdlog::debug("pictures wait for a pipeline that is on disk: {}", text);
    metrics_.waitedForPipeline();
    spdlog::debug("pictures wait for a pipeline that no process has compiled ahead: {}", text);
}

// Drivers compile shaders when they are first used. Where they are compiled behind, only those of the first pictures
// are compiled here, wherever cameras are; else also those of measuring and of a picture at rest, which snapshots are.
// What may be needed later: ahead.h.
void Drawing::warmUp() {
    const Progress progress;
    const bool all = ways_.hasAll();
    WarmUp pictures(*renderer_, batches_.front()->submission, *shown_.scene, shown_.simulation, all);
    const PlanView& own = pictures.own();
    const RenderSettings planned = planning_.planner().settings(shown_.simulation, {&own, 1}, false, Clock::now());
    if (all) {
        pictures.draw(planned, false);
        pictures.draw(planning_.planner().once(shown_.simulation, own).settings, true);
    } else if (ways_.has(planned, false)) {
        pictures.draw(planned, false);
    } else { // cameras that go anywhere are drawn this way until others are compiled
        const Clock::time_point begun = Clock::now();
        pictures.drawForEveryCamera(planned, false);
        const bool known = Clock::now() - begun < kKnown; // the shaders of measuring probably are, too
        if (known)
            WarmUp(*renderer_, batches_.front()->submission, *shown_.scene, shown_.simulation, true)
                .draw(planned, false);
        ways_.add(shadersOf(planned, false), known);
    }
}

void Drawing::prepare(const Scene& scene, uint32_t capacity) {
    renderer_.reset(); // makes room for the other
    renderer_.emplace(device_, scene, capacity);
}

void Drawing::showScene() {
    ways_.clear(shown_.drawn);
    planning_.showScene(frame_ms_);
    measuring_.forget();
}

void Drawing::wait(std::chrono::nanoseconds longest) {
    if (lit_.isOnDevice()) return lit_.wait(longest, encoding_.workers());
    if (on_device_->submission.commands.wait(uint64_t(longest.count()))) done(*on_device_);
}

bool Drawing::isDue() const { return shown_.simulation.tick() != rendered_tick_ || batch_planner_.someoneWaits(); }

void Drawing::draw() {
    if (light()) return;
    if (Batch* batch = freeBatch(); batch && render(*batch)) on_device_ = batch;
}

Batch* Drawing::freeBatch() {
    for (const auto& batch : batches_)
        if (batch->isFree()) return batch.get();
    return nullptr; // the encoders are behind: newer poses replace older ones meanwhile
}

// Viewers who draw by themselves come first: their light takes little time, and pictures of the same tick need it, too.
bool Drawing::light() {
    const Clock::time_point now = Clock::now();
    audience_.list(viewers_);
    const bool any = std::ranges::any_of(viewers_, [](const auto& one) { return one->drawHz() > 0; });
    bool submitted = false;
    if (any && whyNotDrawable(shown_).empty() && lit_.isDue(viewers_, shown_, now)) {
        const Planner& planner = planning_.planner();
        const bool pictures = !planner.plan().passes.empty() && batch_planner_.activeViewers() > 0;
        const PlanView own = ownView(*shown_.scene);
        RenderSettings settings = pictures ? planner.plan().chosen.settings : planning_.settings({&own, 1}, now);
        settings.exposure = shown_.simulation.now().render.exposure;
        lit_.submit(*renderer_, shown_, settings, viewers_, now);
        submitted = true;
    }
    viewers_.clear();
    return submitted;
}

// False when nothing is on the device then.
bool Drawing::render(Batch& batch) {
    batch.taken = Clock::now();
    batch.raw.reset();
    audience_.list(viewers_);
    if (whyNotDrawable(shown_).empty())
        std::erase_if(viewers_, [](const auto& viewer) { return viewer->drawHz() > 0; });
    if (planning_.isLate(batch.taken)) ++shown_.version;    // also pictures at rest are drawn anew
    if (layers_wait_ && *layers_wait_ != ways_.version()) { // pictures at rest may have layers now
        layers_wait_.reset();
        ++shown_.version;
    }
    Planner& planner = planning_.planner();
    const Plan& before = planner.plan();
    const bool known = !before.passes.empty(); // false: nothing of this scene was drawn yet
    if (const uint64_t version = ways_.version();
        version != deferred_with_ || batch.taken - deferred_since_ > kLookAtDeferred) {
        deferred_with_ = version, deferred_since_ = batch.taken;
        deferred_.clear();
    }
    const bool any =
        batch_planner_.plan(viewers_, shown_.version,
                            {.budget_ms = frame_ms_,
                             .most_ms = most_frame_ms_,
                             .ms_per_pixel = known ? before.chosen.views_ms / pixelsOf(planner.inputs().views) : 0,
                             .still_ratio = known ? before.still_ms / before.chosen.ms() : 1,
                             .still = !known || planner.drawable(finer(before.chosen.settings), true),
                             .full = shown_.hasSeveralHues(),
                             .deferred = deferred_,
                             .layers_last = pace_.lasts(batch.taken),
                             .bytes = mostPlaneBytes()},
                            batch.taken, batch);
    viewers_.clear();
    if (!any) return false;
    batch.tick = shown_.simulation.tick();
    batch.state_hash = shown_.simulation.stateHash();
    if (batch.one_shot) return renderOneShot(batch);
    most_full_ms_ = std::max(most_full_ms_, batch_planner_.fullBatchMs());
    rendered_tick_ = batch.tick;
    if (std::ranges::any_of(batch.jobs, [](const BatchJob& job) { return job.due.request.layers > 0; }))
        pace_.look(shown_.simulation);

    const RenderSettings& planned = planning_.settings(batch.views, batch.taken);
    const Plan& plan = planner.plan();
    const bool rests = plan.relaxed == 0 && batch_planner_.camerasRest(batch.taken);
    const double dearer = plan.still_ms / plan.chosen.ms();
    batch.finer = batch.still_pictures ||
                  (refinement_.next({rests, batch_planner_.fullBatchMs(), dearer, frame_ms_}, batch.taken) &&
                   planner.drawable(finer(planned), false));
    if (batch.still_pictures && !planner.drawable(finer(planned), true)) { // the way is a new one
        for (const BatchJob& job : batch.jobs) job.viewer->abandon(job.due.frame_id);
        return false;
    }
    RenderSettings settings = batch.finer ? finer(planned) : planned;
    settings.exposure = shown_.simulation.now().render.exposure; // it is in no plan
    batch.error = float(plan.chosen.error);
    for (EyeRequest& eye : batch.eyes)
        eye.rate = planner.rateOf({eye.pose, eye.width, eye.height}, settings, batch.still_pictures);
    batch.settings = settings;
    measuring_.before(batch, planner, ways_);
    if (!submit(batch, settings)) return false;
    planner.refresh(shown_.simulation, batch.views, batch.taken);
    return true;
}

// A one-shot picture has a plan of its own, which neither depends on that of the viewers nor changes it. The picture
// waits for that plan's shaders, since another way would give another picture. After kLongestDeferral any way will do
// whose shaders are compiled; without one the picture waits on. Nobody else waits.
bool Drawing::renderOneShot(Batch& batch) {
    const bool late = batch.taken - batch.jobs.front().due.request.received > kLongestDeferral;
    const Candidate way = planning_.planner().once(shown_.simulation, batch.views.front(), late);
    const bool shown =
        shown_.drawn == featuresOf(shown_.simulation.now()); // True: all that is in the scene can be drawn
    if ((!late && !shown) || !planning_.planner().drawable(way.settings, true)) {
        for (const BatchJob& job : batch.jobs) {
            job.viewer->abandon(job.due.frame_id);
            deferred_.push_back(job.viewer->id());
        }
        return false;
    }
    batch.finer = true;
    batch.error = float(way.error);
    batch.submission.probe.pixels.clear();
    const EyeRequest& eye = batch.eyes.front();
    if (batch.jobs.front().due.request.alpha != Alpha::none)
        batch.raw = RawPicture{.width = eye.width,
                               .height = eye.height,
                               .radiance = {},
                               .view_depth = {},
                               .eye = eye.pose,
                               .sky = shown_.scene->sky,
                               .exposure = way.settings.exposure,
                               .filmic = way.settings.tone_map == "filmic"};
    return submit(batch, way.settings);
}

// Pictures come without layers until the shaders for these are compiled.
void Drawing::askForLayers(Batch& batch, const RenderSettings& settings) {
    for (EyeRequest& eye : batch.eyes) {
        if (eye.depth_layers == 0) continue;
        RenderSettings own = settings;
        if (eye.rate) own.rate = eye.rate;
        if (ways_.mayHaveLayers(own)) continue;
        eye.depth_layers = 0;
        layers_wait_ = ways_.version();
    }
}

// False when the device cannot draw the batch, or memory is short; it is dropped then.
bool Drawing::submit(Batch& batch, const RenderSettings& settings) {
    askForLayers(batch, settings);
    const SceneFeatures features = shown_.features();
    const bool full = batch.still_pictures || shown_.hasSeveralHues();
    const uint64_t pipelines_before = pipelines_made_;
    submitter_ = std::this_thread::get_id();
    try {
        checkPictures(batch.eyes, full, features, picture_memory_ / 2, mostPlaneBytes());
        renderer_->drawOnly(shown_.drawn);
        renderer_->keepRadiance(batch.raw.has_value());
        renderer_->submit(batch.submission, shown_.simulation, batch.eyes, &settings, full);
    } catch (const gpu::DeviceLost&) {
        throw;
    } catch (const gpu::Error& error) {
        drop(batch, error.what());
        return false;
    } catch (const std::bad_alloc&) {
        drop(batch, "out of memory; use smaller pictures, fewer viewers or fewer particles");
        return false;
    }
    batch.waited = pipelines_made_ != pipelines_before;
    idle_memory_.use(Renderer::pictureBytes(batch.eyes, full, features), batch.taken);
    return true;
}

// Of one batch: all batches have planes of their own, and the device has those of one more.
uint64_t Drawing::mostPlaneBytes() const {
    return std::min(Renderer::mostPictureBytes(device_), picture_memory_ / 2 / (batches_.size() + 1));
}

void Drawing::giveBack(Clock::time_point now) {
    if (idle_memory_.spare(now)) {
        renderer_->giveBack();
        encoding_.giveBack();
        for (const auto& batch : batches_) batch->spare = true;
    }
    for (const auto& batch : batches_)
        if (batch->spare && batch->isFree()) {
            batch->submission.giveBack();
            batch->spare = false;
        }
}

uint64_t Drawing::pictureBytes() const {
    uint64_t bytes = renderer_->pictureBytes() + encoding_.bytes();
    for (const auto& batch : batches_) bytes += batch->submission.pictureBytes();
    return bytes;
}

// A batch that cannot be drawn. The viewer with the largest pictures is sent away, and the log says why. The others get
// later frames.
void Drawing::drop(Batch& batch, const char* why) {
    const auto pixels = [](const BatchJob& job) {
        return uint64_t{job.due.request.width} * job.due.request.height * job.due.request.views;
    };
    const auto largest = std::max_element(batch.jobs.begin(), batch.jobs.end(),
                                          [&](const BatchJob& a, const BatchJob& b) { return pixels(a) < pixels(b); });
    const PoseRequest& asked = largest->due.request;
    spdlog::error("a batch of {} pictures was given up, and viewer {} with the largest, {}x{}, is sent away: {}",
                  batch.eyes.size(), largest->viewer->id(), asked.width, asked.height, why);
    for (const BatchJob& job : batch.jobs) {
        metrics_.failed();
        job.viewer->abandon(job.due.frame_id);
    }
    measuring_.after(batch, false);
    largest->viewer->refuse("the device cannot draw pictures of this size: ask for smaller ones");
    const auto slot =
        std::find_if(batches_.begin(), batches_.end(), [&](const auto& one) { return one.get() == &batch; });
    *slot = std::make_unique<Batch>(device_); // with its memory
    prepare(*shown_.scene, shown_.simulation.capacity());
}

// The device is done with the batch.
void Drawing::done(Batch& batch) {
    on_device_ = nullptr;
    batch.done = Clock::now();
    measuring_.after(batch, true);
    const float took = Millis(batch.done - batch.taken).count();
    if (batch.raw) { // the device has nothing else to do then
        batch.raw->radiance = renderer_->readRadiance();
        batch.raw->view_depth = renderer_->readDepths();
    }
    const std::span<const gpu::PassSample> samples = batch.submission.commands.readTimes();
    const DeviceLedger::Times times = ledger_.book(samples, batch);
    metrics_.drawn(times.shared_ms, times.views_ms, batch.finer);
    if (!batch.waited) {
        // Who looks at how a picture is made costs more time. Accuracy is not given up for that.
        const auto planned = float(std::max(double(took) - times.shown_ms, 0.0));
        if (!batch.one_shot) planning_.planner().took(double(planned * batch.full_batch_ratio), batch.done);
        measuring_.learnCosts(batch, samples, planning_.planner());
        batch_planner_.took(batch, times.shared_ms, times.all() > 0 ? double(took) / times.all() : 1, !batch.finer);
        if (batch.finer && !batch.still_pictures) refinement_.took(double(took));
    }

    encoding_.take(batch);
}

void Drawing::tellLoad(Clock::time_point now) {
    audience_.list(viewers_);
    ids_.clear();
    for (const auto& viewer : viewers_) ids_.push_back(viewer->id());
    std::ranges::sort(ids_);
    measuring_.read(ids_, planning_.planner(), now);
    for (const auto& viewer : viewers_)
        viewer->deviceHas({batch_planner_.predictMs(viewer->id()), most_full_ms_, frame_ms_,
                           batch_planner_.activeViewers(), planning_.planner().exhausted()});
    viewers_.clear();
    audience_.setTimeFor(uint32_t(std::clamp(batch_planner_.viewersInTime(kLeastPixels, most_frame_ms_), 1.0, 1e9)));
    planning_.priceLists(audience_.commands());
    metrics_.budget(most_full_ms_ / frame_ms_);
    audience_.budget_used = float(most_full_ms_ / frame_ms_);
    most_full_ms_ = on_device_ ? batch_planner_.fullBatchMs() : 0; // of the batch that goes on
}

void Drawing::report(SceneReport& report) const {
    report.passes = ledger_.passes();
    report.errors.assign(measuring_.errors().begin(), measuring_.errors().end());
    const LightWork& work = renderer_->lightWork();
    report.light = {work.voxel_rays, work.froxel_rays, work.places};
    report.memory = {device_.memoryInUse(), device_.peakMemory(),
                     shown_.simulation.bytes() + renderer_->particleBytes()};
    metrics_.kept(pictureBytes(), device_.pipelines().size());
}

} // namespace brume
