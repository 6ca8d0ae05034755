// What the server counts and times, for Prometheus. One object for the process; thread-safe.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/viewer/audience.h"

namespace brume {

class Metrics {
public:
    Metrics();
    ~Metrics();

    // --- the frame loop's side ---
    void ticked(float work_ms); // one tick of the shared work: commands, simulation, light
    // The device is done with a batch: times of the passes that all views share, and of those of each view. `finer`:
    // true for a batch with less error, because cameras rest.
    void drawn(double shared_ms, double views_ms, bool finer = false);
    // A command's way from the connection to the tick that took it.
    void commandTaken(float ms);
    void budget(double used);                            // time of a frame of all viewers over the frame budget
    void kept(uint64_t picture_bytes, size_t pipelines); // on the device: picture buffers, compiled pipelines
    void waitedForPipeline();                            // pictures waited until one was compiled
    void encoded(uint32_t pictures);                     // viewers with the same camera share one
    void rendered(const EncodedFrame& frame); // a frame is encoded; times its wait, render, encode and gpu stages
    void failed();                            // a due frame was abandoned

    // --- the connections' side ---
    void sent(size_t bytes, float queue_ms); // a frame went to a viewer; queue: JPEG ready -> handed to the socket
    void superseded(uint64_t frames);        // a newer frame came before these were sent
    void refused(std::string_view reason);   // of a fixed set: an error code's name, or which check refused
    void requested(std::string_view route, unsigned status);
    void connected(int change); // +1 or -1 open connections

    // --- others ---
    // A number that somebody else counts.
    struct Sample {
        const char *name, *help; // which live for ever
        bool counter;            // True: it only grows; false: a gauge
        double value;
    };
    // `samples` is called for each text(), by any thread. To be called before the server listens.
    void collect(std::function<std::vector<Sample>()> samples) { samples_ = std::move(samples); }

    // Of another room of the same process: its series have the label `room`.
    struct OfRoom {
        std::string name;
        const Metrics& metrics;
        const Audience& audience;
    };
    // The exposition text: all of the above, and the audience, the passes and the process as they are now.
    std::string text(const Audience& audience, std::span<const OfRoom> rooms = {}) const;

private:
    struct Families;
    std::unique_ptr<Families> families_;
    std::function<std::vector<Sample>()> samples_; // empty: there are none
};

} // namespace brume
