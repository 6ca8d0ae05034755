#include "server/frame.h"

#include <algorithm>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/encode/picture_encoder.h"
#include "server/loop/asks.h"

namespace brume {
namespace {

constexpr auto kReportEvery = std::chrono::seconds(1);
constexpr auto kLoadEvery = std::chrono::milliseconds(100);
constexpr int kPlansPause = 8;                                // times as long as the last plan took
constexpr auto kLookAtHeld = std::chrono::seconds(1);         // for those who have waited long enough
constexpr auto kLongestLook = std::chrono::milliseconds(100); // at ticks, before other things are seen to

// That a snapshot waits for its shaders. Then it is drawn another way.
constexpr auto kLongestHold = std::chrono::seconds(10);

using Millis = std::chrono::duration<float, std::milli>;

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
    for (const EyeRequest& eye : eyes) bytes += PlaneLayout{eye.width, eye.height, full}.bytes();
    if (bytes > planes)
        throw gpu::Error(
            fmt::format("pictures of {} MiB together, --picture-memory and the device allow {} MiB: ask for "
                        "smaller ones or allow more",
                        bytes >> 20, planes >> 20));
}

} // namespace

FrameLoop::~FrameLoop() { stop(); }

void FrameLoop::start(std::function<void()> on_failure, std::unique_ptr<TickSource> ticks) {
    ticks_ = ticks ? std::move(ticks) : std::make_unique<LocalTicks>(audience_.commands(), Clock::now());
    thread_ = std::thread([this, on_failure = std::move(on_failure)] {
        try {
            run();
        } catch (...) {
            failure_ = std::current_exception();
            audience_.ready = false;
            on_failure();
        }
    });
}

void FrameLoop::stop() {
    {
        const std::scoped_lock lock(mutex_);
        stopping_ = true;
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
}

// tick    commands -> Simulation::step                                       once
// batch   due viewers -> BatchPlanner -> Planner -> Renderer::submit         once for all viewers in it
// frame   planes -> encodePictures -> Viewer::deliver                        per viewer, on the encoders' threads
void FrameLoop::run() {
    drawing_ = std::this_thread::get_id();
    if (const auto beginning = ticks_->beginning())
        begin(*beginning);
    else if (ticked_)
        ticked_(simulation_, {}, false);
    audience_.ready = serves_ = ticks_->serves();
    for (;;) {
        // Wait for the next tick, or for the device if that is earlier.
        const Clock::time_point asleep = Clock::now();
        const Clock::time_point due = ticks_->due();
        const auto until_tick =
            due <= asleep ? Clock::duration::zero() : std::min<Clock::duration>(due - asleep, kReportEvery);
        if (on_device_) {
            if (on_device_->submission.commands.wait(uint64_t(std::chrono::nanoseconds(until_tick).count())))
                encode(*on_device_);
            const std::scoped_lock lock(mutex_);
            if (stopping_ && !on_device_) return;
        } else {
            std::unique_lock lock(mutex_);
            if (wake_.wait_for(lock, until_tick, [&] { return stopping_; })) return;
        }

        if (!on_device_) takeScene();
        const Clock::time_point now = Clock::now();
        if (!on_device_) giveBack(now);
        if (const auto beginning = ticks_->beginning()) begin(*beginning);
        const bool sought = ticks_->seeks();
        while (ticks_->take(now, commands_)) {
            tick();
            if (Clock::now() - now > kLongestLook) break; // many ticks of a seek: the rest comes with the next look
        }
        followTicks(sought);
        followLists();
        const bool is_new = simulation_.tick() != rendered_tick_ || ticks_->stands() || batch_planner_.someoneWaits();
        if (!on_device_ && !ticks_->seeks() && is_new)
            if (Batch* batch = freeBatch(); batch && render(*batch)) on_device_ = batch;
        if (now - load_told_ >= kLoadEvery) tellLoad(now);
        if (changed_ || now - reported_ >= kReportEvery) report(now);
    }
}

void FrameLoop::tick() {
    const Clock::time_point begin = Clock::now();
    const bool empty = simulation_.liveCount() == 0;
    simulation_.step(commands_);
    for (const Command& command : commands_) {
        const Asks asks = asksFor(command.body);
        if (asks != Asks::nothing) changed_ = asked_ = true;
        if (asks == Asks::at_once) replan_ = true;
    }
    if (empty != (simulation_.liveCount() == 0)) changed_ = replan_ = true;
    if (!commands_.empty() || !simulation_.now().simulation.paused) ++scene_version_;
    if (!simulation_.refused().empty()) tellRefused();
    metrics_.ticked(Millis(Clock::now() - begin).count());
    for (const Command& command : commands_)
        if (command.received != Clock::time_point()) metrics_.commandTaken(Millis(begin - command.received).count());
    planner_->setFrameBudget(frame_ms_);
    planner_->setLawFactor(law_factor_);
    if (ticked_) ticked_(simulation_, commands_, true);
}

// Who moves a slider asks for a plan with each step. Plans for what is asked for take a part of the loop's time; what
// comes meanwhile is in the next one.
const RenderSettings& FrameLoop::plannedSettings(const Batch& batch) {
    const bool anew = replan_ || (asked_ && batch.taken >= next_asked_);
    const Clock::time_point begin = Clock::now();
    const RenderSettings& planned = planner_->settings(simulation_, batch.views, anew, batch.taken);
    drawn_before_ = asked_ && !anew;
    if (anew) {
        replan_ = asked_ = false;
        const Clock::time_point end = Clock::now();
        next_asked_ = end + kPlansPause * (end - begin);
    }
    return planned;
}

FrameLoop::Batch* FrameLoop::freeBatch() {
    for (const auto& batch : batches_)
        if (batch->pending.load() == 0) return batch.get();
    return nullptr; // the encoders are behind: newer poses replace older ones meanwhile
}

// Takes the newest pose of viewers whose window is open and submits their pictures. False when nothing is on the device
// then.
bool FrameLoop::render(Batch& batch) {
    batch.taken = Clock::now();
    audience_.list(viewers_);
    if (drawn_before_ && batch.taken >= next_asked_) ++scene_version_; // also pictures at rest are drawn anew
    const Plan& before = planner_->plan();
    const bool known = !before.passes.empty(); // false: nothing of this scene was drawn yet
    if (const uint64_t version = ways_.version(); version != held_with_ || batch.taken - held_since_ > kLookAtHeld) {
        held_with_ = version, held_since_ = batch.taken;
        held_.clear();
    }
    const bool any =
        batch_planner_.plan(viewers_, scene_version_,
                            {.budget_ms = frame_ms_,
                             .most_ms = most_frame_ms_,
                             .ms_per_pixel = known ? before.chosen.views_ms / pixelsOf(planner_->inputs().views) : 0,
                             .still_ratio = known ? before.still_ms / before.chosen.ms() : 1,
                             .still = !known || planner_->drawable(finer(before.chosen.settings), true),
                             .full = hasSeveralHues(),
                             .held = held_,
                             .bytes = mostPlaneBytes()},
                            batch.taken, batch);
    viewers_.clear();
    if (!any) return false;
    batch.tick = simulation_.tick();
    batch.state_hash = simulation_.stateHash();
    if (batch.one_shot) return renderOneShot(batch);
    most_full_ms_ = std::max(most_full_ms_, batch_planner_.fullBatchMs());
    rendered_tick_ = batch.tick;

    const RenderSettings& planned = plannedSettings(batch);
    const Plan& plan = planner_->plan();
    const bool rests = plan.relaxed == 0 && batch_planner_.camerasRest(batch.taken);
    const double dearer = plan.still_ms / plan.chosen.ms();
    batch.finer = batch.still_pictures ||
                  (refinement_.next({rests, batch_planner_.fullBatchMs(), dearer, frame_ms_}, batch.taken) &&
                   planner_->drawable(finer(planned), false));
    if (batch.still_pictures && !planner_->drawable(finer(planned), true)) { // the way is a new one
        for (const BatchJob& job : batch.jobs) job.viewer->abandon(job.due.frame_id);
        return false;
    }
    RenderSettings settings = batch.finer ? finer(planned) : planned;
    settings.exposure = simulation_.now().render.exposure; // it is in no plan
    batch.error = float(plan.chosen.error);
    for (EyeRequest& eye : batch.eyes)
        eye.rate = planner_->rateOf({eye.pose, eye.width, eye.height}, settings, batch.still_pictures);
    batch.settings = settings;
    beginMeasuring(batch, settings);
    showMeasured(batch);
    tellMeasured(batch, settings.method);
    if (!submit(batch, settings)) return false;
    planner_->refresh(simulation_, batch.views, batch.taken);
    return true;
}

// Neither the plan of the viewers nor their times take part in it, nor are they changed by it. It waits for its
// shaders, since another way would give another picture. After kLongestHold any way that is compiled does; without one
// it waits on. Nobody else waits.
bool FrameLoop::renderOneShot(Batch& batch) {
    const bool late = batch.taken - batch.jobs.front().due.request.received > kLongestHold;
    const Candidate way = planner_->once(simulation_, batch.views.front(), late);
    const bool shown = drawn_ == featuresOf(simulation_.now()); // True: all that is in the scene can be drawn
    if ((!late && !shown) || !planner_->drawable(way.settings, true)) {
        for (const BatchJob& job : batch.jobs) {
            job.viewer->abandon(job.due.frame_id);
            held_.push_back(job.viewer->id());
        }
        return false;
    }
    batch.finer = true;
    batch.error = float(way.error);
    batch.submission.probe.pixels.clear();
    return submit(batch, way.settings);
}

bool FrameLoop::hasSeveralHues() const { return huesOf(simulation_.now(), simulation_.liveCount()).size() > 1; }

// False when the device cannot draw the batch, or memory is short; it is dropped then.
bool FrameLoop::submit(Batch& batch, const RenderSettings& settings) {
    const SceneFeatures features = featuresOf(scene_, simulation_.now(), drawn_);
    const bool full = batch.still_pictures || hasSeveralHues();
    const uint64_t pipelines_before = pipelines_made_;
    try {
        checkPictures(batch.eyes, full, features, picture_memory_ / 2, mostPlaneBytes());
        renderer_->draws(drawn_);
        renderer_->submit(batch.submission, simulation_, batch.eyes, &settings, full);
    } catch (const gpu::DeviceLost&) {
        throw;
    } catch (const gpu::Error& error) {
        drop(batch, error.what());
        return false;
    } catch (const std::bad_alloc&) {
        drop(batch, "out of memory; use smaller pictures, fewer viewers or fewer particles");
        return false;
    }
    batch.compiled = pipelines_made_ != pipelines_before;
    room_.use(Renderer::pictureBytes(batch.eyes, full, features), batch.taken);
    return true;
}

// Of one batch: all batches have planes of their own, and the device has those of one more.
uint64_t FrameLoop::mostPlaneBytes() const {
    return std::min(Renderer::mostPictureBytes(device_), picture_memory_ / 2 / (batches_.size() + 1));
}

// Frees the memory of pictures when they have been smaller, or none, for a minute. Nothing is on the device.
void FrameLoop::giveBack(Clock::time_point now) {
    if (room_.spare(now)) {
        renderer_->giveBack();
        workers_.giveBack();
        for (const auto& batch : batches_) batch->spare = true;
    }
    for (const auto& batch : batches_)
        if (batch->spare && batch->pending.load() == 0) {
            batch->submission.giveBack();
            batch->spare = false;
        }
}

uint64_t FrameLoop::pictureBytes() const {
    uint64_t bytes = renderer_->pictureBytes() + workers_.bytes();
    for (const auto& batch : batches_) bytes += batch->submission.pictureBytes();
    return bytes;
}

// A batch that cannot be drawn: its viewers get other frames later, but for the one with the largest pictures, who is
// told why.
void FrameLoop::drop(Batch& batch, const char* why) {
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
    endMeasuring(batch, false);
    largest->viewer->refuse("the device cannot draw pictures of this size: ask for smaller ones");
    const auto slot =
        std::find_if(batches_.begin(), batches_.end(), [&](const auto& one) { return one.get() == &batch; });
    *slot = std::make_unique<Batch>(device_); // with its memory
    renderer_.reset();
    renderer_.emplace(device_, scene_, simulation_.capacity());
}

// The device is done with the batch: every viewer's planes go to the encoders, and from there to the viewer.
void FrameLoop::encode(Batch& batch) {
    on_device_ = nullptr;
    batch.done = Clock::now();
    endMeasuring(batch, true);
    const float took = Millis(batch.done - batch.taken).count();
    const std::span<const gpu::PassSample> samples = batch.submission.commands.readTimes();
    const DeviceLedger::Times times = ledger_.book(samples, batch);
    metrics_.drawn(times.shared_ms, times.views_ms, batch.finer);
    if (!batch.compiled) {
        // The pictures of others are not less accurate for who looks at how they are made.
        const auto planned = float(std::max(double(took) - times.shown_ms, 0.0));
        if (!batch.one_shot) planner_->took(double(planned * batch.full_batch_ratio), batch.done);
        learnCosts(batch, samples);
        batch_planner_.took(batch, times.shared_ms, times.all() > 0 ? double(took) / times.all() : 1, !batch.finer);
        if (batch.finer && !batch.still_pictures) refinement_.took(double(took));
    }

    const std::span<const PictureView> pictures = batch.submission.pictures();
    const auto draws = [&](const BatchJob& job) { return &job == &batch.jobs[job.pictures]; };
    batch.pending = uint32_t(std::count_if(batch.jobs.begin(), batch.jobs.end(), draws));
    for (const BatchJob& job : batch.jobs) {
        if (!draws(job)) continue;
        workers_.give(
            [this, &batch, &job, views = pictures.subspan(job.first_eye, job.due.request.views)](JpegEncoder& jpeg) {
                deliver(batch, job.pictures, views, jpeg);
                batch.pending.fetch_sub(1);
            });
    }
}

// Encodes one job's pictures, for all viewers that asked for the same ones. On an encoder's thread, where nothing may
// be thrown: a frame that cannot be made, for want of memory for example, is lost, and its viewer gets a later one.
void FrameLoop::deliver(const Batch& batch, uint32_t job, std::span<const PictureView> views,
                        JpegEncoder& jpeg) noexcept {
    size_t next = job; // first of the jobs that have not got their frame
    try {
        const PoseRequest& wanted = batch.jobs[job].due.request;
        const EncodedPictures pictures =
            encodePictures(views, {wanted.quality, wanted.lossless, wanted.still_picture}, jpeg);
        const Clock::time_point encoded = Clock::now();
        metrics_.encoded(uint32_t(views.size()));
        for (; next < batch.jobs.size(); ++next) {
            const BatchJob& one = batch.jobs[next];
            if (one.pictures != job) continue;
            auto frame = std::make_shared<EncodedFrame>();
            frame->id = one.due.frame_id;
            frame->tick = batch.tick;
            frame->state_hash = batch.state_hash;
            frame->request = one.due.request;
            frame->request.quality = pictures.quality;
            frame->again = one.due.again;
            frame->wait_ms = Millis(batch.taken - one.due.request.received).count();
            frame->render_ms = Millis(batch.done - batch.taken).count();
            frame->encode_ms = Millis(encoded - batch.done).count();
            frame->gpu_ms = one.gpu_ms;
            frame->error = batch.error;
            frame->measured = one.measured;
            frame->encoded = encoded;
            frame->jpeg = pictures.bytes;
            frame->png = pictures.format == PictureFormat::png;
            metrics_.rendered(*frame);
            one.viewer->deliver(std::move(frame));
        }
        return;
    } catch (const std::exception& e) {
        spdlog::error("a picture is lost: {}", e.what());
    } catch (...) {
        spdlog::error("a picture is lost");
    }
    for (; next < batch.jobs.size(); ++next) {
        if (batch.jobs[next].pictures != job) continue;
        metrics_.failed();
        batch.jobs[next].viewer->abandon(batch.jobs[next].due.frame_id);
    }
}

} // namespace brume
