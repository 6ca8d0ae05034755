#include "server/frame.h"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "server/encode/png.h"
#include "server/plan/memory.h"

namespace brume {
namespace {

constexpr auto kTick = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kTickSeconds));
// When this far behind, the simulation lets time pass without it: a stopped process does not fast-forward.
constexpr auto kMostBehind = std::chrono::milliseconds(250);
constexpr auto kReportEvery = std::chrono::seconds(1);
constexpr auto kLoadEvery = std::chrono::milliseconds(100);
constexpr size_t kMostEyes = 64;   // of a submission: who comes later comes first in the next one
constexpr float kSmoothing = 0.1f; // weight of the newest sample in a pass's time
constexpr auto kRestsFor = std::chrono::milliseconds(150);
constexpr size_t kMostPng = 4 << 20;    // bytes; a picture that takes more comes as
constexpr uint8_t kNearlyLossless = 97; // JPEG of this quality, 4:4:4

// `count`. Throws SceneError when so many particles do not fit the memory that there is for them.
uint32_t bounded(const Scene& scene, uint32_t count, uint64_t memory) {
    const std::string wrong = memoryRefusal(count, memory);
    if (!wrong.empty()) throw SceneError("scene '" + scene.name + "': " + wrong);
    return count;
}

} // namespace

// One tick's pictures for all viewers that were due: on the device, then with the encoders, then free again.
struct FrameLoop::Batch {
    explicit Batch(const gpu::Device& device) : submission(device, "batch") {}

    struct Job {
        std::shared_ptr<Viewer> viewer;
        Viewer::Due due;
        uint32_t pictures;  // number of the first job with the same pictures, which makes them
        uint32_t first_eye; // of them
        float gpu_ms = 0;
    };
    Submission submission;
    std::vector<Job> jobs;
    uint64_t tick = 0, state_hash = 0;
    Clock::time_point taken{}, done{};
    float whole = 1;                  // what one of all who were due would take, over what this one does; predicted
    bool fine = false;                // of what rests
    bool finer = false;               // with less error: of that, and where there is time
    std::atomic<uint32_t> pending{0}; // jobs not encoded yet
};

FrameLoop::FrameLoop(const Scene& scene, const gpu::Device& device, Audience& audience, Metrics& metrics, const Options& options)
    : device_(device), audience_(audience), metrics_(metrics), scene_(scene), ticked_(options.ticked),
      frame_ms_(options.frame_ms), simulation_(scene),
      renderer_(device, scene, bounded(scene, simulation_.capacity(), options.memory)),
      planner_(scene_, options.costs, options.frame_ms), refinement_(options.refine_moving), workers_(options.encode_threads) {
    for (unsigned i = 0; i < std::max(options.batches, 2u); ++i) batches_.push_back(std::make_unique<Batch>(device));
    warmUp();
}

// One picture that nobody sees, as the first viewer is likely to want it: drivers compile shaders when they are first used, and
// nobody should wait for that. What may be needed later: ahead.h.
void FrameLoop::warmUp() {
    const PlanView own = ownView(scene_);
    const EyeRequest eye{own.pose, own.width, own.height};
    Submission& submission = batches_.front()->submission;
    renderer_.submit(submission, simulation_, {&eye, 1}, &planner_.settings(simulation_, {&own, 1}, false, Clock::now()));
    while (!submission.commands.wait(1'000'000'000)) {
    }
}

FrameLoop::~FrameLoop() { stop(); }

void FrameLoop::start(std::function<void()> on_failure) {
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

// tick    commands -> Simulation::step -> (when something is rendered) upload -> shadow maps            once, shared
// viewer  pose -> opaque -> cull -> sort -> medium -> compose -> read back -> JPEG -> Viewer::deliver   per viewer
void FrameLoop::run() {
    if (ticked_) ticked_(simulation_, {});
    Clock::time_point next_tick = Clock::now();
    report(next_tick);
    audience_.ready = true;
    for (;;) {
        // Wait for the next tick, or for the device if that is earlier.
        const auto until_tick = std::max(next_tick - Clock::now(), Clock::duration::zero());
        if (on_device_) {
            if (on_device_->submission.commands.wait(uint64_t(std::chrono::nanoseconds(until_tick).count()))) encode(*on_device_);
            const std::scoped_lock lock(mutex_);
            if (stopping_ && !on_device_) return;
        } else {
            std::unique_lock lock(mutex_);
            if (wake_.wait_for(lock, until_tick, [&] { return stopping_; })) return;
        }

        const Clock::time_point now = Clock::now();
        if (now - next_tick > kMostBehind) next_tick = now;
        for (; next_tick <= now; next_tick += kTick) tick();

        if (!on_device_ && simulation_.tick() != rendered_tick_)
            if (Batch* batch = freeBatch(); batch && render(*batch)) on_device_ = batch;
        if (now - load_told_ >= kLoadEvery) tellLoad(now);
        if (changed_ || now - reported_ >= kReportEvery) report(now);
    }
}

void FrameLoop::tick() {
    const Clock::time_point begin = Clock::now();
    audience_.commands().drain(commands_);
    simulation_.step(commands_);
    if (!commands_.empty()) changed_ = replan_ = true;
    if (!commands_.empty() || !simulation_.now().paused) ++scene_version_;
    metrics_.ticked(Millis(Clock::now() - begin).count());
    planner_.setFrameBudget(frame_ms_);
    planner_.setCompiled(compiled_);
    if (ticked_) ticked_(simulation_, commands_);
}

FrameLoop::Batch* FrameLoop::freeBatch() {
    for (const auto& batch : batches_)
        if (batch->pending.load() == 0) return batch.get();
    return nullptr; // the encoders are behind: newer poses replace older ones meanwhile
}

// Of the viewers that are due, as many as there is device time for, as the batch's jobs, and their eyes.
void FrameLoop::gather(Batch& batch, bool fine) {
    batch.jobs.clear();
    eyes_.clear();
    requests_.clear();
    wishes_.clear();
    std::erase_if(viewers_, [&](const std::shared_ptr<Viewer>& viewer) {
        const auto due = viewer->due(batch.taken, scene_version_, fine);
        if (!due) return true;
        const auto same = std::find_if(requests_.begin(), requests_.end(),
                                       [&](const PoseRequest& request) { return samePictures(request, *due); });
        wishes_.push_back({viewer->id(), double(due->width) * due->height * due->views, due->views, viewer->every(),
                           uint32_t(same - requests_.begin())});
        requests_.push_back(*due);
        return false;
    });
    if (wishes_.empty()) return;
    for (const uint32_t number :
         schedule_.choose(wishes_, {frame_ms_, fine ? planner_.plan().rests_ms / planner_.plan().chosen.ms() : 1, kMostEyes},
                          batch.taken, kTick))
        if (const auto due = viewers_[number]->take(requests_[number], batch.taken, scene_version_))
            addJob(batch, viewers_[number], *due);
}

void FrameLoop::addJob(Batch& batch, const std::shared_ptr<Viewer>& viewer, const Viewer::Due& due) {
    const auto same = std::find_if(batch.jobs.begin(), batch.jobs.end(),
                                   [&](const Batch::Job& job) { return samePictures(job.due.request, due.request); });
    if (same != batch.jobs.end()) {
        batch.jobs.push_back({viewer, due, same->pictures, same->first_eye});
        return;
    }
    batch.jobs.push_back({viewer, due, uint32_t(batch.jobs.size()), uint32_t(eyes_.size())});
    for (int eye = 0; eye < due.request.views; ++eye)
        eyes_.push_back({eyePose(due.request.pose, eye, due.request.views), due.request.width, due.request.height, eye == 1});
}

// Takes the newest pose of viewers whose window is open and submits their pictures. False when there is none.
bool FrameLoop::render(Batch& batch) {
    batch.taken = Clock::now();
    audience_.list(viewers_);
    gather(batch, false);
    const bool fine = wishes_.empty(); // nothing has changed for anybody: there is time for what rests
    if (fine) {
        audience_.list(viewers_);
        gather(batch, true);
    }
    viewers_.clear();
    if (batch.jobs.empty()) return false;
    whole_ms_ = std::max(whole_ms_, schedule_.wholeMs());
    rendered_tick_ = batch.tick = simulation_.tick();
    batch.state_hash = simulation_.stateHash();
    batch.whole = schedule_.chosenMs() > 0 ? float(schedule_.wholeMs() / schedule_.chosenMs()) : 1;
    views_.clear(); // of all who are due, in this batch or not
    for (size_t i = 0; i < wishes_.size(); ++i)
        for (int eye = 0; wishes_[i].like == i && eye < requests_[i].views; ++eye)
            views_.push_back({eyePose(requests_[i].pose, eye, requests_[i].views), requests_[i].width, requests_[i].height});
    const RenderSettings& planned = planner_.settings(simulation_, views_, std::exchange(replan_, false), batch.taken);
    batch.fine = fine;
    const double dearer = planner_.plan().rests_ms / planner_.plan().chosen.ms();
    batch.finer = fine || refinement_.next({camerasRest(batch.taken), schedule_.wholeMs(), dearer, frame_ms_}, batch.taken);
    const RenderSettings settings = batch.finer ? finer(planned) : planned;
    for (EyeRequest& eye : eyes_) eye.rate = planner_.rateOf({eye.pose, eye.width, eye.height}, settings);
    renderer_.submit(batch.submission, simulation_, eyes_, &settings, fine);
    planner_.refresh(simulation_, views_, batch.taken);
    return true;
}

// The device is done with the batch: every viewer's planes go to the encoders, and from there to the viewer.
void FrameLoop::encode(Batch& batch) {
    on_device_ = nullptr;
    batch.done = Clock::now();
    const auto took = Millis(batch.done - batch.taken).count();
    planner_.took(double(took * batch.whole), batch.done);
    audience_.frameTook(took * batch.whole);
    const std::span<const PictureView> pictures = batch.submission.pictures();
    const std::span<const gpu::PassSample> samples = batch.submission.commands.readTimes();
    countPasses(samples, uint32_t(pictures.size()));

    double shared_ms = 0, views_ms = 0;
    for (const gpu::PassSample& sample : samples) (sample.view == gpu::kShared ? shared_ms : views_ms) += double(sample.ms);
    metrics_.drawn(shared_ms, views_ms, batch.finer);
    shareTime(batch, samples, shared_ms, views_ms);
    if (batch.finer && !batch.fine) refinement_.took(double(took));

    const auto makes = [&](const Batch::Job& job) { return &job == &batch.jobs[job.pictures]; };
    batch.pending = uint32_t(std::count_if(batch.jobs.begin(), batch.jobs.end(), makes));
    for (const Batch::Job& job : batch.jobs) {
        if (!makes(job)) continue;
        workers_.give([this, &batch, &job, views = pictures.subspan(job.first_eye, job.due.request.views)](JpegEncoder& jpeg) {
            deliver(batch, job.pictures, views, jpeg);
            batch.pending.fetch_sub(1);
        });
    }
}

// Passes of all views count together, per view.
void FrameLoop::countPasses(std::span<const gpu::PassSample> samples, uint32_t pictures) {
    for (PassTime& pass : passes_) {
        float ms = 0;
        uint32_t times = 0;
        for (const gpu::PassSample& sample : samples)
            if (pass.name == sample.name) ms += sample.ms, times = sample.view == gpu::kEach ? pictures : times + 1;
        if (times) pass.ms += kSmoothing * (ms / float(times) - pass.ms);
    }
    for (const gpu::PassSample& sample : samples)
        if (std::none_of(passes_.begin(), passes_.end(), [&](const PassTime& p) { return p.name == sample.name; }))
            passes_.push_back({sample.name, sample.view == gpu::kEach ? sample.ms / float(pictures) : sample.ms});
}

// Each viewer's part of the device's time; of passes that draw all of them together, by its pixels. What the loop and the driver
// need besides (recording, upload) goes to the schedule in the same parts.
void FrameLoop::shareTime(Batch& batch, std::span<const gpu::PassSample> samples, double shared_ms, double views_ms) {
    double pixels = 0;
    for (const EyeRequest& eye : eyes_) pixels += double(eye.width) * eye.height;
    const double took = std::chrono::duration<double, std::milli>(batch.done - batch.taken).count(), all = shared_ms + views_ms;
    const double besides = all > 0 ? took / all : 1;
    schedule_.sharedTook(besides * shared_ms);
    for (Batch::Job& job : batch.jobs) {
        const PoseRequest& request = job.due.request;
        const double own = double(request.width) * request.height * request.views;
        job.gpu_ms = 0;
        for (const gpu::PassSample& sample : samples) {
            if (sample.view == gpu::kEach)
                job.gpu_ms += sample.ms * float(own / pixels);
            else if (sample.view != gpu::kShared && sample.view - job.first_eye < request.views)
                job.gpu_ms += sample.ms;
        }
        if (!batch.finer) schedule_.took(job.viewer->id(), own, besides * double(job.gpu_ms));
    }
}

// Encodes one job's pictures, for all viewers that asked for the same ones. On an encoder's thread.
void FrameLoop::deliver(const Batch& batch, uint32_t job, std::span<const PictureView> views, JpegEncoder& jpeg) {
    std::array<Jpeg, 2> bytes;
    const PoseRequest& wanted = batch.jobs[job].due.request;
    bool png = wanted.lossless;
    std::string failure;
    try {
        for (size_t eye = 0; png && eye < views.size(); ++eye) {
            bytes[eye] = std::make_shared<const std::vector<uint8_t>>(encodePng(views[eye], kMostPng));
            png = !bytes[eye]->empty();
        }
        for (size_t eye = 0; !png && eye < views.size(); ++eye)
            bytes[eye] = std::make_shared<const std::vector<uint8_t>>(
                jpeg.encode(views[eye], wanted.lossless ? kNearlyLossless : wanted.quality));
        metrics_.encoded(uint32_t(views.size()));
    } catch (const std::exception& e) {
        failure = e.what();
    }
    const Clock::time_point encoded = Clock::now();
    for (size_t i = job; i < batch.jobs.size(); ++i) {
        const auto& [viewer, due, pictures, first_eye, gpu_ms] = batch.jobs[i];
        if (pictures != job) continue;
        if (!failure.empty()) {
            spdlog::error("frame {} of viewer {} is lost: {}", due.frame_id, viewer->id(), failure);
            metrics_.failed();
            viewer->abandon(due.frame_id);
            continue;
        }
        auto frame = std::make_shared<EncodedFrame>();
        frame->id = due.frame_id;
        frame->tick = batch.tick;
        frame->state_hash = batch.state_hash;
        frame->request = due.request;
        frame->again = due.again;
        frame->wait_ms = Millis(batch.taken - due.request.received).count();
        frame->render_ms = Millis(batch.done - batch.taken).count();
        frame->encode_ms = Millis(encoded - batch.done).count();
        frame->gpu_ms = gpu_ms;
        frame->encoded = encoded;
        frame->jpeg = bytes;
        frame->png = png;
        if (wanted.lossless) frame->request.quality = png ? 100 : kNearlyLossless;
        metrics_.rendered(*frame);
        viewer->deliver(std::move(frame));
    }
}

// All who are due, drawn now, and with nothing given up for anybody.
bool FrameLoop::camerasRest(Clock::time_point now) const {
    return planner_.plan().relaxed == 0 && schedule_.chosenMs() > 0.999 * schedule_.wholeMs() &&
           std::all_of(requests_.begin(), requests_.end(),
                       [&](const PoseRequest& r) { return !r.lowered && now - r.since >= kRestsFor; });
}

// To all viewers, and to who watches the server.
void FrameLoop::tellLoad(Clock::time_point now) {
    load_told_ = now;
    audience_.list(viewers_);
    for (const auto& viewer : viewers_)
        viewer->deviceHas(
            {schedule_.predict(viewer->id()), whole_ms_, frame_ms_, std::max(schedule_.active(), 1u), planner_.exhausted()});
    viewers_.clear();
    metrics_.budget(whole_ms_ / frame_ms_);
    if (!on_device_) whole_ms_ = 0;
}

void FrameLoop::report(Clock::time_point now) {
    reported_ = now;
    changed_ = false;
    auto report = std::make_shared<SceneReport>();
    const SceneNow& scene = simulation_.now();
    report->tick = simulation_.tick();
    report->state_hash = simulation_.stateHash();
    report->particles = simulation_.liveCount();
    report->paused = scene.paused;
    report->light = scene.light;
    report->medium = scene.medium;
    report->render = scene.render;
    const Plan& plan = planner_.plan();
    report->plan = {plan.chosen.settings, plan.chosen.error, plan.chosen.ms(), plan.relaxed};
    report->plan.settings.quadrature = quadratureOf(plan.chosen.settings);
    report->passes = passes_;
    report->memory = {device_.memoryInUse(), device_.peakMemory(), simulation_.bytes() + renderer_.particleBytes()};
    audience_.publish(std::move(report));
}

} // namespace brume
