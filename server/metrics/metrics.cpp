#include "server/metrics/metrics.h"

#include <algorithm>
#include <span>

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include "server/metrics/busy.h"
#include "server/metrics/process.h"

namespace brume {
namespace {

namespace pm = prometheus;

// Seconds, from what a fast GPU needs to what makes a viewer leave.
const pm::Histogram::BucketBoundaries kSeconds{0.00025, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.016,
                                               0.033,   0.066,  0.133, 0.266, 0.533, 1,     2};

// Seconds: finer about the length of a tick, of which a quarter is to be seen.
const pm::Histogram::BucketBoundaries kTickParts{0.002, 0.004, 0.006, 0.008, 0.010, 0.012, 0.014, 0.016,
                                                 0.018, 0.020, 0.022, 0.024, 0.028, 0.032, 0.040, 0.050,
                                                 0.066, 0.1,   0.2,   0.5,   1,     2,     5};

pm::MetricFamily counter(const Metrics::Sample& sample) {
    pm::ClientMetric metric;
    metric.counter.value = sample.value;
    return {sample.name, sample.help, pm::MetricType::Counter, {metric}};
}

// Numbers of several kinds, each since it began.
pm::MetricFamily counters(const char* name, const char* help,
                          std::initializer_list<std::pair<const char*, uint64_t>> kinds) {
    pm::MetricFamily family{name, help, pm::MetricType::Counter, {}};
    for (const auto& [kind, value] : kinds) {
        pm::ClientMetric metric;
        metric.label = {{"kind", kind}};
        metric.counter.value = double(value);
        family.metric.push_back(metric);
    }
    return family;
}

// How many viewers are at each of a few values; all of them, also where nobody is.
template <class Of>
void count(pm::MetricFamily& family, std::vector<pm::ClientMetric::Label> label, const char* name, uint32_t lo,
           uint32_t hi, const std::vector<Viewer::Link>& links, Of of) {
    label.push_back({name, ""});
    for (uint32_t value = lo; value <= hi; ++value) {
        pm::ClientMetric metric;
        label.back().value = std::to_string(value);
        metric.label = label;
        metric.gauge.value = double(
            std::count_if(links.begin(), links.end(), [&](const Viewer::Link& link) { return of(link) == value; }));
        family.metric.push_back(std::move(metric));
    }
}

pm::MetricFamily windows(const std::vector<Viewer::Link>& links, uint32_t most) {
    pm::MetricFamily family{
        "brume_viewers_by_window", "Viewers by the frames that may be on their way.", pm::MetricType::Gauge, {}};
    count(family, {}, "frames", 1, most, links, [](const Viewer::Link& link) { return link.frames; });
    return family;
}

pm::MetricFamily qualities(const std::vector<Viewer::Link>& links) {
    pm::MetricFamily family{
        "brume_viewers_by_quality", "Viewers by the steps of quality given up; 0: none.", pm::MetricType::Gauge, {}};
    count(family, {{"limit", "link"}}, "step", 0, QualityControl::kSteps - 1, links,
          [](const auto& link) { return link.level; });
    count(family, {{"limit", "device"}}, "step", 0, QualityControl::kDeviceSteps - 1, links,
          [](const auto& link) { return link.device_level; });
    return family;
}

pm::MetricFamily passGauges(const SceneReport& report) {
    pm::MetricFamily family{"brume_pass_seconds", "GPU time of each pass, smoothed.", pm::MetricType::Gauge, {}};
    for (const PassTime& pass : report.passes) {
        pm::ClientMetric metric;
        metric.label = {{"pass", pass.name}};
        metric.gauge.value = pass.ms * 1e-3;
        family.metric.push_back(std::move(metric));
    }
    return family;
}

// Of the viewer whose pictures err most, of those that are measured well enough.
void addErrors(std::span<const ViewError> errors, std::vector<pm::MetricFamily>& all) {
    const ViewError* worst = nullptr;
    for (const ViewError& one : errors)
        if (one.error.known() && (!worst || one.error.rmse > worst->error.rmse)) worst = &one;
    if (!worst) return;
    const ErrorEstimate& e = worst->error;
    all.push_back(gauge("brume_picture_error", "Measured relative RMSE of the worst viewer's pictures.", e.rmse));
    all.push_back(gauge("brume_picture_error_low", "Lower bound of it, of 95 %.", e.low));
    all.push_back(gauge("brume_picture_error_high", "Upper bound of it, of 95 %.", e.high));
    all.push_back(gauge("brume_picture_error_predicted", "What the plan's laws predict for it.", e.law));
    all.push_back(gauge("brume_picture_bias", "Mean relative error of it; positive is too bright.", e.bias));
}

} // namespace

struct Metrics::Families {
    // All of them, and the audience and the passes as they are now.
    std::vector<pm::MetricFamily> of(const Audience& audience) const;

    pm::Registry registry;
    pm::Family<pm::Counter>& frames =
        pm::BuildCounter().Name("brume_frames_total").Help("Frames by what became of them.").Register(registry);
    pm::Counter& rendered = frames.Add({{"fate", "rendered"}});
    pm::Counter& sent = frames.Add({{"fate", "sent"}});
    pm::Counter& superseded = frames.Add({{"fate", "superseded"}});
    pm::Counter& failed = frames.Add({{"fate", "failed"}});
    pm::Counter& pictures = pm::BuildCounter()
                                .Name("brume_pictures_total")
                                .Help("Pictures drawn and encoded; frames of viewers with the same camera share one.")
                                .Register(registry)
                                .Add({});
    pm::Counter& batches = pm::BuildCounter()
                               .Name("brume_batches_total")
                               .Help("Submissions to the device; each draws every viewer that is due.")
                               .Register(registry)
                               .Add({});
    pm::Counter& finer = pm::BuildCounter()
                             .Name("brume_finer_batches_total")
                             .Help("Batches drawn with less error than the plan asks for, since cameras rest.")
                             .Register(registry)
                             .Add({});
    pm::Gauge& budget_used = pm::BuildGauge()
                                 .Name("brume_frame_budget_used_ratio")
                                 .Help("What a frame of all viewers takes of the device, over --frame-budget.")
                                 .Register(registry)
                                 .Add({});
    pm::Family<pm::Counter>& device =
        pm::BuildCounter()
            .Name("brume_device_seconds_total")
            .Help("Device time of passes: once a batch for all its viewers, and for each view.")
            .Register(registry);
    pm::Counter& shared_passes = device.Add({{"part", "shared"}});
    pm::Counter& view_passes = device.Add({{"part", "view"}});
    pm::Gauge& pictures_kept = pm::BuildGauge()
                                   .Name("brume_picture_memory_bytes")
                                   .Help("Targets and planes of pictures on the device, scratch of the encoders.")
                                   .Register(registry)
                                   .Add({});
    pm::Gauge& pipelines =
        pm::BuildGauge().Name("brume_pipelines").Help("Compiled pipelines that are kept.").Register(registry).Add({});
    pm::Counter& waited_pipelines = pm::BuildCounter()
                                        .Name("brume_pipelines_waited_total")
                                        .Help("Pipelines that pictures waited for, since nothing had compiled them.")
                                        .Register(registry)
                                        .Add({});
    pm::Counter& bytes = pm::BuildCounter()
                             .Name("brume_frame_bytes_total")
                             .Help("Bytes of frames handed to sockets.")
                             .Register(registry)
                             .Add({});
    pm::Family<pm::Histogram>& stages = pm::BuildHistogram()
                                            .Name("brume_stage_seconds")
                                            .Help("Time of a frame in each stage; gpu is part of render.")
                                            .Register(registry);
    pm::Histogram& wait = stages.Add({{"stage", "wait"}}, kSeconds);
    pm::Histogram& render = stages.Add({{"stage", "render"}}, kSeconds);
    pm::Histogram& encode = stages.Add({{"stage", "encode"}}, kSeconds);
    pm::Histogram& queue = stages.Add({{"stage", "queue"}}, kSeconds);
    pm::Histogram& gpu = stages.Add({{"stage", "gpu"}}, kSeconds);
    pm::Histogram& tick = pm::BuildHistogram()
                              .Name("brume_tick_seconds")
                              .Help("Work that viewers share, per tick: commands, simulation, light.")
                              .Register(registry)
                              .Add({}, kSeconds);
    pm::Histogram& command = pm::BuildHistogram()
                                 .Name("brume_command_to_tick_seconds")
                                 .Help("From a command's arrival at this server to the tick that took it.")
                                 .Register(registry)
                                 .Add({}, kTickParts);
    pm::Family<pm::Counter>& refused = pm::BuildCounter()
                                           .Name("brume_refused_total")
                                           .Help("Messages and connections refused, by reason.")
                                           .Register(registry);
    pm::Family<pm::Counter>& requests = pm::BuildCounter()
                                            .Name("brume_http_requests_total")
                                            .Help("HTTP requests by route and status.")
                                            .Register(registry);
    Busy busy;
    pm::Gauge& connections =
        pm::BuildGauge().Name("brume_connections").Help("Open connections of any kind.").Register(registry).Add({});
};

Metrics::Metrics() : families_(std::make_unique<Families>()) {}
Metrics::~Metrics() = default;

void Metrics::ticked(float work_ms) { families_->tick.Observe(work_ms * 1e-3); }

void Metrics::commandTaken(float ms) { families_->command.Observe(ms * 1e-3); }

void Metrics::budget(double used) { families_->budget_used.Set(used); }

void Metrics::kept(uint64_t picture_bytes, size_t pipelines) {
    families_->pictures_kept.Set(double(picture_bytes));
    families_->pipelines.Set(double(pipelines));
}

void Metrics::waitedForPipeline() { families_->waited_pipelines.Increment(); }

void Metrics::drawn(double shared_ms, double views_ms, bool finer) {
    if (finer) families_->finer.Increment();
    families_->batches.Increment();
    families_->shared_passes.Increment(shared_ms * 1e-3);
    families_->view_passes.Increment(views_ms * 1e-3);
    families_->busy.add(shared_ms + views_ms);
}

void Metrics::rendered(const EncodedFrame& frame) {
    families_->rendered.Increment();
    if (!frame.repeats) families_->wait.Observe(frame.wait_ms * 1e-3);
    families_->render.Observe(frame.render_ms * 1e-3);
    families_->encode.Observe(frame.encode_ms * 1e-3);
    families_->gpu.Observe(frame.gpu_ms * 1e-3);
}

void Metrics::encoded(uint32_t pictures) { families_->pictures.Increment(pictures); }

void Metrics::failed() { families_->failed.Increment(); }

void Metrics::sent(size_t bytes, float queue_ms) {
    families_->sent.Increment();
    families_->bytes.Increment(double(bytes));
    families_->queue.Observe(queue_ms * 1e-3);
}

void Metrics::superseded(uint64_t frames) {
    if (frames > 0) families_->superseded.Increment(double(frames));
}

void Metrics::refused(std::string_view reason) {
    families_->refused.Add({{"reason", std::string(reason)}}).Increment();
}

void Metrics::requested(std::string_view route, unsigned status) {
    families_->requests.Add({{"route", std::string(route)}, {"status", std::to_string(status)}}).Increment();
}

void Metrics::connected(int change) { families_->connections.Increment(change); }

std::vector<pm::MetricFamily> Metrics::Families::of(const Audience& audience) const {
    const auto report = audience.report();
    std::vector<std::shared_ptr<Viewer>> viewers;
    audience.list(viewers);
    uint32_t in_flight = 0;
    std::vector<Viewer::Link> links;
    for (const auto& viewer : viewers) {
        in_flight += viewer->counts().in_flight;
        links.push_back(viewer->link());
    }

    auto all = registry.Collect();
    all.push_back(
        gauge("brume_viewers", "Viewers of the scene: pages, clients, streams and snapshots.", double(viewers.size())));
    all.push_back(gauge("brume_frames_in_flight", "Frames handed out and not yet acknowledged.", in_flight));
    all.push_back(gauge("brume_tick", "Tick of the simulation.", double(report->tick)));
    all.push_back(gauge("brume_particles", "Live particles.", report->particles));
    all.push_back(
        gauge("brume_particle_memory_bytes", "CPU memory that the particles take.", double(report->memory.particles)));
    all.push_back(gauge("brume_device_memory_bytes", "Device memory in use.", double(report->memory.device)));
    all.push_back(
        gauge("brume_device_memory_peak_bytes", "The most there ever was.", double(report->memory.device_peak)));
    const auto& light = report->light;
    all.push_back(counters("brume_shadow_rays_total", "Shadow rays to voxels that viewers share, and to froxels.",
                           {{"voxel", light.voxel_rays}, {"froxel", light.froxel_rays}}));
    all.push_back(counters("brume_light_places_total", "Places for which light was computed to be interpolated.",
                           {{"node", light.places}}));
    all.push_back(gauge("brume_plan_error", "Predicted relative RMSE of the pictures.", report->plan.error));
    all.push_back(gauge("brume_plan_relaxed", "Steps of accuracy given up under overload; 0 when there is none.",
                        report->plan.relaxed));
    addErrors(report->errors, all);
    all.push_back(gauge("brume_ready", "1 when frames can be had.", audience.ready ? 1 : 0));
    all.push_back(gauge("brume_device_busy_ratio",
                        "Part of the last ten seconds in which the device drew; 1: all of them.", busy.ratio()));
    all.push_back(windows(links, audience.maxInFlight()));
    all.push_back(qualities(links));
    all.push_back(passGauges(*report));
    return all;
}

std::string Metrics::text(const Audience& audience, std::span<const OfRoom> rooms) const {
    const auto allOf = [](const Metrics& of, const Audience& people) {
        auto all = of.families_->of(people);
        for (const Sample& sample : of.samples_ ? of.samples_() : std::vector<Sample>())
            all.push_back(sample.counter ? counter(sample) : gauge(sample.name, sample.help, sample.value));
        return all;
    };
    auto all = allOf(*this, audience);
    for (const OfRoom& room : rooms)
        for (pm::MetricFamily& family : allOf(room.metrics, room.audience)) {
            for (pm::ClientMetric& metric : family.metric) metric.label.push_back({"room", room.name});
            const auto same = std::ranges::find(all, family.name, &pm::MetricFamily::name);
            if (same == all.end())
                all.push_back(std::move(family));
            else
                same->metric.insert(same->metric.end(), family.metric.begin(), family.metric.end());
        }
    for (pm::MetricFamily& family : processFamilies()) all.push_back(std::move(family));
    return pm::TextSerializer().Serialize(all);
}

} // namespace brume
