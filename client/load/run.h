// What was measured with one number of viewers.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace brume::load {

// Of the server, over the time of a run unless it says otherwise; NaN for what it does not export.
struct ServerCost {
    double cpu_s = 0;                   // all threads
    double shared_s = 0, views_s = 0;   // of the device: passes once for all viewers, passes of each view
    double batches = 0, rendered = 0;   // submissions to the device, frames
    double superseded = 0;              // frames that a newer one replaced before they were sent
    double memory_bytes = 0;            // resident, at the end
    double plan_error = 0, relaxed = 0; // at the end: the plan's relative RMSE, and steps of accuracy given up under overload
    std::map<std::string, double> passes_ms; // at the end: each pass, smoothed
};

// Milliseconds of a frame in each stage (wire::Stages), and of its decoding here; means over the frames of a run.
struct StageMeans {
    double wait = 0, render = 0, gpu = 0, encode = 0, queue = 0, decode = 0;
};

// A viewer that lost the server and came back, on the clock of client::nowUs().
struct Return {
    uint64_t lost_us = 0, back_us = 0; // its connection ended; the first frame of the next
};

struct Run {
    uint32_t viewers = 0;
    double seconds = 0, warm_up_s = 0;
    std::vector<uint64_t> frames;    // per viewer
    uint64_t bytes = 0;              // of all frame messages
    std::vector<float> latencies_ms; // of all viewers: pose sent -> the first frame of that pose or a later one
    std::vector<float> ages_ms;      // of all frames: the pose that it shows sent -> the frame got
    std::vector<Return> returns;
    double oldest_unanswered_ms = 0; // at the end: the pose that has waited the longest
    StageMeans stages;
    uint64_t errors = 0; // that the server told
    std::string first_error;
    ServerCost server;
    double own_cpu_s = 0;      // of this program
    double machine_busy_s = 0; // of all cores, everything that runs included; NaN when unknown

    uint64_t allFrames() const;
    double leastFps() const; // of the slowest viewer; so on
    double medianFps() const;
    double mostFps() const;
    double latencyMs(double fraction) const; // nearest rank; NaN without a sample
    double ageMs(double fraction) const;     // so on; 1 is the oldest
    double cpuMsPerFrame() const { return 1e3 * server.cpu_s / server.rendered; }
    double deviceMsPerFrame() const { return 1e3 * (server.shared_s + server.views_s) / server.rendered; }
};

} // namespace brume::load
