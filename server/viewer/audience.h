// All viewers of the scene, their commands, and the report on the scene that they all get. Thread-safe.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/scene.h"
#include "common/settings.h"
#include "server/error/error_window.h"
#include "server/sim/command.h"
#include "server/sim/lists.h"
#include "server/viewer/particle_requests.h"
#include "server/viewer/people.h"
#include "server/viewer/replay_control.h"
#include "server/viewer/scene_requests.h"
#include "server/viewer/viewer.h"

namespace brume {

// The state of the scene as viewers see it in their panels. Immutable once published.
struct SceneReport {
    uint64_t tick = 0, state_hash = 0;
    uint32_t particles = 0;
    glm::vec3 lo{0}, hi{0}; // m, the medium's box: every particle out to two standard deviations
    // Of liveSettings(), in that order: as the scene and commands ask for.
    std::vector<SettingValue> settings = defaultValues();
    uint64_t settings_version = 0; // Simulation::settingsVersion()
    SceneLists lists;
    uint64_t lists_hash = 0;  // Simulation::listsHash()
    std::string standstill;   // why no tick comes, one line; empty: ticks come
    std::string not_drawable; // why viewers cannot draw by themselves, one line; empty: they can
    std::string undo;         // Simulation::undoText()
    std::string preparing;    // name of another scene that is being made ready; empty: none is
    struct {
        std::string method;
        std::string quadrature;       // empty for a method without a choice
        std::string text;             // method and settings in a few words
        uint32_t rate = 0, slabs = 0; // pixels between rays, slabs along them; 0 for a method without rays
        double error = 0;             // predicted relative RMSE
        double promised = 0;          // relative RMSE that the pictures may have; 0: nothing is promised
        double ms = 0;                // predicted device time of a frame of all viewers
        uint32_t relaxed = 0;         // overload steps: how often accuracy was given up
    } plan;
    std::vector<PassTime> passes;
    std::vector<ViewError> errors; // measured, by viewer and method
    struct {
        uint64_t device = 0, device_peak = 0; // bytes of resources on the device: now, and at most so far
        uint64_t particles = 0;               // bytes of CPU memory for particles
    } memory;
    struct {
        uint64_t voxel_rays = 0, froxel_rays = 0; // shadow rays to what viewers share, and to what is each viewer's
        uint64_t places = 0;                      // for which light was computed to be interpolated
    } light;                                      // since the scene was loaded
};

// The scene that is shown, as loaded. Immutable once published: another scene has facts of its own.
struct SceneFacts {
    Scene scene;
    std::vector<SettingValue> starts; // the scene's values of liveSettings(), in that order
    std::vector<std::string> others;  // names of the scenes that an operator can switch to
};
// With the scene's own values of all live settings.
std::shared_ptr<const SceneFacts> sceneFacts(const Scene& scene, std::vector<std::string> others = {});

// Facts about the server that do not change while it runs.
struct ServerFacts {
    std::string device;
    std::vector<std::string> methods;

    // The texts that a live setting may have: of render.method those of this server, of others those of the table.
    std::vector<std::string> choicesOf(const SceneSetting& setting) const;
};

// Who asks to join.
struct Newcomer {
    // What counts as one person where places and time are shared out: an address, or the name in a token.
    std::string owner;
    bool is_operator = false;   // True: may take the place that is kept for operators
    uint32_t max_in_flight = 0; // a smaller window than the server's; 0: the server's
    std::string key;            // of a viewer whose connection was lost; empty: somebody new
    std::string token;          // the name in its token; empty: it has none
    bool draws = false;         // True: it draws by itself where the scene allows it
    uint8_t role = 0;           // wire::Role's value
    bool is_person = false;     // True: it is one of people(); false: it takes pictures by a URL
};

class Audience {
public:
    // `max_in_flight`: the most frames in flight for one viewer; Pacing may decide for fewer.
    Audience(ServerFacts facts, std::shared_ptr<const SceneFacts> scene, uint32_t max_viewers, uint32_t max_in_flight);

    const ServerFacts& facts() const { return facts_; }
    std::shared_ptr<const SceneFacts> scene() const; // never null
    // Another scene is shown from now on: every viewer is told.
    void setScene(std::shared_ptr<const SceneFacts> scene);

    // Another scene is being made ready: viewers are told its name. Empty: it is shown, or given up.
    void prepare(const std::string& name);
    std::string preparing() const;

    // Viewers that have joined stay, also when there are more than the new limits. `per_owner`: Newcomer::owner.
    // Viewers who draw by themselves have other places: `drawing`, and three quarters of them for one owner.
    void setMaxViewers(uint32_t max_viewers, uint32_t per_owner = ~0u, uint32_t drawing = 0);
    uint32_t maxInFlight() const { return max_in_flight_; }

    // Admits a viewer, or says in one line why not. A viewer whose connection was lost less than a minute ago gets its
    // id and its pose back, if the name in its token is the same. Its address may be another. What it holds from then
    // on counts for its present owner.
    struct Admission {
        std::shared_ptr<Viewer> viewer; // null: refused
        const char* refusal = "";
    };
    Admission join(std::function<void()> notify, const Newcomer& newcomer = {});
    // The last place is for operators. For servers whose tokens say who is one.
    void keepPlaceForOperators(bool keep) { keeps_place_ = keep; }
    // The device has time for so many viewers at least, each with a small picture. join() refuses more.
    void setTimeFor(uint32_t viewers) { time_for_ = viewers; }
    // Removes the viewer and closes it. `lost`: true if its connection broke, so that it may come back with its key.
    // Precondition: not called from the viewer's own notify.
    void leave(const std::shared_ptr<Viewer>& viewer, bool lost = false);
    uint32_t size() const;
    uint32_t withPictures() const; // those of them who do not draw by themselves
    // How many viewers with pictures there may be at most, as it is now, if they are no operators.
    uint32_t places() const;
    // Fills `out` with the viewers in the order of joining. Reuses its memory.
    void list(std::vector<std::shared_ptr<Viewer>>& out) const;

    CommandQueue& commands() { return commands_; }
    People& people() { return people_; }
    const People& people() const { return people_; }
    SceneRequests& sceneRequests() { return scene_requests_; }
    ParticleRequests& particleRequests() { return particle_requests_; }
    // Of a recording that is looked at: nothing else takes commands then. Null otherwise.
    ReplayControl* replay() { return replay_.get(); }
    // To be called before viewers come.
    void setReplay(std::shared_ptr<ReplayControl> replay) { replay_ = std::move(replay); }

    void publish(std::shared_ptr<const SceneReport> report);
    std::shared_ptr<const SceneReport> report() const; // never null
    // A number that grows when viewers should get a new report at once: a setting changed, a viewer came or went.
    uint64_t revision() const;

    // True: the frame loop runs and delivers frames. Answered at /readyz.
    std::atomic<bool> ready{false};
    // What a frame of all viewers takes of the device, over the frame budget; above 1 something is given up.
    std::atomic<float> budget_used{0};

private:
    uint32_t countPictures() const; // Precondition: mutex_ is held
    // Null: it is not. Precondition of both: mutex_ is held.
    const char* whyFull(const Newcomer& newcomer) const;
    const char* whyFullOfDrawing(const Newcomer& newcomer) const;
    uint32_t placesFor(bool is_operator) const; // by the limit alone. Precondition: mutex_ is held
    void remember(const std::shared_ptr<Viewer>& viewer);

    const ServerFacts facts_;
    uint32_t max_viewers_, max_in_flight_, max_per_owner_ = ~0u, max_drawing_ = 0;
    std::atomic<uint32_t> time_for_{~0u};
    std::atomic<bool> keeps_place_{false};
    CommandQueue commands_;
    People people_;
    SceneRequests scene_requests_;
    ParticleRequests particle_requests_;
    std::shared_ptr<ReplayControl> replay_;
    mutable std::mutex mutex_;
    std::vector<std::shared_ptr<Viewer>> viewers_;
    uint32_t next_id_ = 1;
    struct Lost {
        std::string key, owner, token;
        uint32_t id;
        std::optional<PoseRequest> pose;
        Clock::time_point until;
    };
    std::vector<Lost> lost_; // viewers whose connection broke, the oldest first
    std::vector<Lost>::iterator lostOf(const Newcomer& newcomer);
    std::shared_ptr<const SceneFacts> scene_;
    std::string preparing_;
    std::shared_ptr<const SceneReport> report_;
    uint64_t revision_ = 0;
};

} // namespace brume
