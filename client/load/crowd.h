// Many viewers of one server, or of several, in one thread. Each has its own camera, sends 61 poses a second and
// acknowledges each frame at once.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "client/load/options.h"
#include "client/load/run.h"
#include "client/native/interrupt.h"
#include "client/native/jpeg.h"

namespace brume::load {

// Every failure throws std::runtime_error: one line.
class Crowd {
public:
    // `options` and `interrupt` must outlive it.
    // The viewers are spread over the servers in turn.
    Crowd(const Options& options, std::vector<client::Endpoint> servers, uint32_t viewers,
          client::Interrupt& interrupt);
    ~Crowd();

    // Runs until every viewer has had a few frames and the warm-up is over. Returns how long that took, in seconds.
    double enter();
    // Runs `work` in another thread and serves the viewers meanwhile. Throws what `work` throws.
    void during(const std::function<void()>& work);
    // Serves the viewers for so long and counts what they get. Precondition: enter() has returned.
    Run watch(double seconds);
    // Sends every viewer's goodbye.
    void leave();

    // Size, scene, device: as the first viewer got them. Precondition: enter() has returned.
    const client::Granted& granted() const { return *granted_; }

private:
    struct Viewer;

    // Serves every viewer once, then waits for the sockets or the next pose.
    void step();
    void talk(Viewer& viewer, uint64_t now);
    bool sendPose(client::Session& session, Pose pose) const; // with layers, if they are asked for
    void listen(Viewer& viewer);
    void take(Viewer& viewer, const client::Received& message);
    void takeLit(Viewer& viewer, const client::Received& message);
    void taken(Viewer& viewer, const client::Received& message, uint64_t now);
    void welcome(Viewer& viewer);
    void refuse(const Viewer& viewer, const wire::Error& error);
    bool returns(const Viewer& viewer);
    void comeBack(Viewer& viewer, uint64_t now);
    void planReturn(Viewer& viewer, uint64_t now);
    std::optional<size_t> named(const Viewer& viewer);
    // The counts of the viewer's server. Precondition: watch() runs.
    ServerRun& counts(const Viewer& viewer);
    client::Session session(uint32_t number, const Path& path, size_t server, const std::string& key = {});
    [[noreturn]] void fail(const Viewer& viewer, const std::string& why) const;

    const Options& options_;
    std::vector<client::Endpoint> servers_; // servers of the options, then others that goodbyes named
    const size_t given_;                    // number of the first
    client::Interrupt& interrupt_;
    client::Loop loop_;
    std::vector<std::unique_ptr<Viewer>> viewers_;
    client::JpegDecoder decoder_;
    client::Picture picture_;
    std::optional<client::Granted> granted_;
    Agreement agreement_;
    uint64_t next_look_us_ = 0;
    uint64_t start_us_ = 0;         // start of the cameras' paths
    std::optional<double> tick_us_; // when tick 0 was taken, by the message that came with the least delay
    Run* run_ = nullptr;            // the counts of watch(), while it runs; otherwise null
};

} // namespace brume::load
