// What one run measured: a number of viewers over a time.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/load/agreement.h"

namespace brume::load {

// What the server spent in a run; NaN for what it does not export. "At the end" marks values that are not sums over
// the run.
struct ServerCost {
    double cpu_s = 0;                        // all threads
    double shared_s = 0, views_s = 0;        // device time: passes made once for all viewers, passes of each view
    double batches = 0, rendered = 0;        // submissions to the device, frames
    double pictures = 0;                     // drawn: frames with the same camera share one
    double superseded = 0;                   // frames that a newer one replaced before they were sent
    double memory_bytes = 0;                 // resident memory, at the end
    double plan_error = 0;                   // at the end: relative RMSE that the plan expects
    double relaxed = 0;                      // at the end: steps of accuracy given up under overload
    std::map<std::string, double> passes_ms; // at the end: device time of each pass, smoothed
};

// Milliseconds of a frame in each stage (wire::Stages), and of its decoding here; means over the frames of a run.
struct StageMeans {
    double wait = 0, render = 0, gpu = 0, encode = 0, queue = 0, decode = 0;
};

// A viewer that lost its connection and came back. Times are of client::nowUs().
struct Return {
    uint64_t lost_us = 0, back_us = 0; // end of the lost connection; first frame of the next one
};

// What one server gave to its viewers in a run, and what it told of itself. NaN: it does not tell that.
struct ServerRun {
    std::string url;
    uint32_t viewers = 0; // at the end
    uint64_t frames = 0;
    std::vector<float> picture_ms;                     // times of frames from tick to picture: render, encode and queue
    uint64_t pushes = 0, refused = 0;                  // inputs that were sent; those that an Error answered
    double command_p50_ms = NAN, command_p95_ms = NAN; // from a command's arrival to the tick that takes it
    double ticks_per_second = NAN, tick_p50_ms = NAN, tick_p95_ms = NAN; // brume_tick_seconds
    double log_bytes_per_second = NAN;                                   // bytes of the cluster's log that it read
    double lag_ticks = NAN;                                              // at the end: how far it is behind that log
    ServerCost cost;

    double pictureMs(double fraction) const; // percentile of picture_ms, nearest rank; NaN without a frame
};

struct Run {
    uint32_t viewers = 0;
    double seconds = 0, warm_up_s = 0;
    std::vector<uint64_t> frames;    // number of frames of each viewer
    uint64_t bytes = 0;              // size of all frame messages
    std::vector<float> latencies_ms; // for each pose, from sending it to the first frame of it or of a later pose
    std::vector<float> ages_ms;      // for each frame, from sending the pose that it shows to receiving it
    std::vector<Return> returns;
    double oldest_unanswered_ms = 0; // at the end: how long the oldest pose without a frame has waited
    StageMeans stages;
    std::vector<float> errors_measured; // at the end, of each viewer that is told one: relative RMSE of its pictures
    uint64_t errors = 0;                // wire::Error messages
    std::string first_error;
    ServerCost server; // cost of all servers together
    std::vector<ServerRun> servers;
    std::optional<Agreement> agreement; // hashes that servers told, warm-up included; none: there is one server
    double own_cpu_s = 0;               // processor time of this program
    double machine_busy_s = 0;          // processor time of all that runs on the machine, on all cores; NaN if unknown

    uint64_t allFrames() const;
    double leastFps() const; // frames a second of the slowest viewer
    double medianFps() const;
    double mostFps() const;                      // frames a second of the fastest viewer
    double latencyMs(double fraction) const;     // percentile of latencies_ms, nearest rank; NaN without a sample
    double ageMs(double fraction) const;         // percentile of ages_ms; 1: the oldest
    double errorMeasured(double fraction) const; // percentile of errors_measured; NaN without one
    double awayMs(double fraction) const;        // percentile of how long `returns` were away; NaN without one
    double commandP95Ms() const;                 // of the server where it is largest; NaN if none tells it
    double cpuMsPerFrame() const { return 1e3 * server.cpu_s / server.rendered; }
    double deviceMsPerFrame() const { return 1e3 * (server.shared_s + server.views_s) / server.rendered; }
};

} // namespace brume::load
