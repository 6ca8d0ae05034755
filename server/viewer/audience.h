// All viewers of the one scene, and what every one of them is told. Thread-safe.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/scene.h"
#include "server/sim/command.h"
#include "server/viewer/viewer.h"

namespace brume {

// The scene as viewers are told of it; immutable once published.
struct SceneReport {
    uint64_t tick = 0, state_hash = 0;
    uint32_t particles = 0;
    bool paused = false;
    Light light;
    Medium medium;         // extinction, falloff, anisotropy, asymmetry, albedo are current
    RenderSettings render; // as asked for
    struct {
        RenderSettings settings; // in use
        double error = 0;        // relative RMSE, predicted
        double ms = 0;           // of a frame of all viewers, predicted
        uint32_t relaxed = 0;    // steps of accuracy given up under overload
    } plan;
    std::vector<PassTime> passes;
    struct {
        uint64_t device = 0, device_peak = 0; // bytes that resources on the device take, and the most there ever were
        uint64_t particles = 0;               // bytes of the CPU's memory that particles take
    } memory;
};

// What does not change while the server runs.
struct SceneFacts {
    std::string scene, device;
    SceneCamera camera;
    std::vector<std::string> methods, quadratures;
};

class Audience {
public:
    Audience(SceneFacts facts, uint32_t max_viewers, uint32_t max_in_flight); // at most that many frames, as Pacing decides

    const SceneFacts& facts() const { return facts_; }

    // Who is in stays in.
    void setMaxViewers(uint32_t max_viewers);
    uint32_t maxInFlight() const { return max_in_flight_; }

    // Null when the house is full. A viewer may ask for a smaller window than the house's; 0 takes that. With the key of one
    // whose connection was lost less than a minute ago it is that one again, with its pose.
    std::shared_ptr<Viewer> join(std::function<void()> notify, uint32_t max_in_flight = 0, const std::string& key = {});
    // What join() says no for, in one line.
    const char* whyFull() const;
    // Admission: a frame of all viewers takes so long now; nobody is let in who would make it longer than the most (ms).
    void frameTook(float ms);
    void admitUpTo(float ms) { most_frame_ms_ = ms; }
    // Also closes the viewer. Not from its own notify. `lost`: it may come back.
    void leave(const std::shared_ptr<Viewer>& viewer, bool lost = false);
    uint32_t size() const;
    // The viewers in order of joining. Reuses `out`.
    void list(std::vector<std::shared_ptr<Viewer>>& out) const;

    CommandQueue& commands() { return commands_; }

    void publish(std::shared_ptr<const SceneReport> report);
    std::shared_ptr<const SceneReport> report() const; // never null
    // Grows when there is something that viewers should see at once: a setting changed, a viewer came or went.
    uint64_t revision() const;

    // The frame loop runs and frames can be had: /readyz.
    std::atomic<bool> ready{false};

private:
    SceneFacts facts_;
    bool hasTime() const; // with mutex_

    uint32_t max_viewers_, max_in_flight_;
    CommandQueue commands_;
    mutable std::mutex mutex_;
    std::vector<std::shared_ptr<Viewer>> viewers_;
    uint32_t next_id_ = 1;
    float frame_ms_ = 0, most_frame_ms_ = 1e30f; // smoothed
    struct Lost {
        uint32_t id;
        std::optional<PoseRequest> pose;
        Clock::time_point until;
    };
    std::map<std::string, Lost> lost_; // by key; at most kMostLost
    std::shared_ptr<const SceneReport> report_;
    uint64_t revision_ = 0;
};

} // namespace brume
