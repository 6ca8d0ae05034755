// ServedRoom: one scene of the server with all that belongs to it alone: its people, simulation, pictures, recording,
// and its log where several servers share it.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/cluster/node.h"
#include "server/frame/frame_loop.h"
#include "server/loop/device_turns.h"
#include "server/metrics/metrics.h"
#include "server/net/rooms.h"
#include "server/operate/recorder.h"
#include "server/operate/replay_ticks.h"
#include "server/options/options.h"
#include "server/scene_thread.h"

namespace brume {

// What the rooms of a server share.
struct SharedByRooms {
    const gpu::Device& device;
    const CostModel& costs;
    DeviceTurns& turns;
    int argc; // the server's, for processes that compile ahead
    char** argv;
};

// The log of the server's rooms has the name of the scene at "/" unless the options give one.
void nameLog(ServerOptions& options, const Scene& scene);

// The options of another room: those of the server, with this scene, and its own recording and log. Precondition:
// nameLog() was called.
ServerOptions optionsOfRoom(const ServerOptions& server, const std::string& name, const std::string& scene);

class ServedRoom {
public:
    // `name`: empty for the room at "/". `scene`: of the options; or the first of the recording `replay`, which
    // outlives this. Compiles what its first pictures need. Throws what keeps it from that, in one line.
    ServedRoom(std::string name, const ServerOptions& options, const SharedByRooms& shared, Scene scene,
               const RecordingExtent* replay = nullptr);
    ~ServedRoom(); // stop()

    // Ticks and pictures begin. `failed` is called on another thread if they end by themselves.
    void start(std::function<void()> failed);
    // From now on `failed` is not called.
    void willStop() { stopping_ = true; }
    // Nothing is drawn any more. The network must have let go of the room: Rooms::remove().
    void stop();

    const std::string& name() const { return name_; }
    const Scene& scene() const { return scene_; } // that it began with
    Audience& audience() { return audience_; }
    Metrics& metrics() { return metrics_; }
    FrameLoop& frames() { return *frames_; }
    cluster::Node* node() { return node_.get(); }                   // null: this server is alone
    SceneThread* scenes() { return scenes_ ? &*scenes_ : nullptr; } // null: it shows a replay
    // True: the loop has ended by itself.
    bool failed() const { return failed_; }

private:
    FrameLoop::Options frameOptions();

    const std::string name_;
    const ServerOptions options_;
    const SharedByRooms shared_;
    const RecordingExtent* const replay_;
    const Scene scene_;
    Audience audience_;
    Metrics metrics_;
    std::unique_ptr<cluster::Node> node_;
    std::unique_ptr<Recorder> recorder_;
    std::unique_ptr<TickSource> ticks_;                                // until start(); null: the clock's
    std::atomic<bool> stopping_{false}, failed_{false}, ended_{false}; // outlive the loop's thread and the scenes'
    std::optional<FrameLoop> frames_;
    std::optional<SceneThread> scenes_;
};

} // namespace brume
