// What the server counts and times, for Prometheus. One object for the process; thread-safe.
#pragma once

#include <memory>
#include <string>
#include <string_view>

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
    void budget(double used);                            // time of a frame of all viewers over the frame budget
    void kept(uint64_t picture_bytes, size_t pipelines); // on the device: picture buffers, compiled pipelines
    void encoded(uint32_t pictures);                     // viewers with the same camera share one
    void rendered(const EncodedFrame& frame); // a frame is encoded; times its wait, render, encode and gpu stages
    void failed();                            // a due frame was abandoned

    // --- the connections' side ---
    void sent(size_t bytes, float queue_ms); // a frame went to a viewer; queue: JPEG ready -> handed to the socket
    void superseded(uint64_t frames);        // a newer frame came before these were sent
    void refused(std::string_view reason);   // of a fixed set: an error code's name, or which check refused
    void requested(std::string_view route, unsigned status);
    void connected(int change); // +1 or -1 open connections

    // The exposition text: all of the above, and the audience, the passes and the process as they are now.
    std::string text(const Audience& audience) const;

private:
    struct Families;
    std::unique_ptr<Families> families_;
};

} // namespace brume
