// ErrorMeter: the server's own error, measured while it runs. A thread of lowest priority traces some pixels of
// pictures that were sent in double precision, and compares.
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "common/camera.h"
#include "common/lit_medium.h"
#include "server/error/error_window.h"
#include "server/sim/simulation.h"
#include "shaders/shared/show.h"
#include "shaders/shared/types.h"

namespace brume {

// What single errors are told apart by.
struct DrawnWith {
    RenderSettings settings;
    uint64_t version = 0; // Simulation::settingsVersion(): all that people set
    // Of the settings it compares what the plan may choose.
    bool operator==(const DrawnWith& other) const;
};

// Pixels of one picture, with all that a reference needs. It is filled by the frame loop and given back.
struct MeterJob {
    uint32_t viewer = 0;
    DrawnWith with;
    double law = 0; // relative RMSE that the laws predict for this picture; 0: none
    std::shared_ptr<const Scene> scene;
    SceneNow now;
    std::vector<gpu::Particle> particles;
    std::vector<gpu::EllipsoidAxes> axes; // Simulation::axes()
    Pose pose;
    glm::uvec2 size{0};             // pixels
    std::vector<glm::uvec2> pixels; // positions of the pixels that are read back
    std::vector<glm::vec4> values;  // radiance and transmittance of each pixel: ProbeReading::values()
    bool drawn = false;             // ProbeReading::drawn
    // What a viewer draws by itself, without ambient light, in place of `values`. Null: the server draws.
    std::shared_ptr<const lit::Medium> lit;
    bool keeps = false; // True: the error of each pixel is kept, for shown()
    // Set by the meter: the number of scenes before this one, and of jobs before this one.
    uint64_t epoch = 0, number = 0;
};

// RenderSettings::method of jobs whose viewers draw by themselves.
inline constexpr const char* kDrawnByViewer = "viewer";

class ErrorMeter {
public:
    using Time = ErrorWindow::Time;

    // `share`: part of one core's time that it may take, on average; 0: it measures nothing. `clock`: gives what is
    // measured its time.
    explicit ErrorMeter(double share, Time (*clock)() = &Time::clock::now);
    ~ErrorMeter();

    bool measures() const { return share_ > 0; }
    // A job to fill, if there is time for one; otherwise null. It is for the viewer whose pictures were measured
    // longest ago: `viewers` are those to choose from.
    std::unique_ptr<MeterJob> begin(std::span<const uint32_t> viewers, Time now);
    // Takes a job whose pixels were read back, to be measured.
    void give(std::unique_ptr<MeterJob> job);
    // Takes a job back whose picture was not drawn.
    void drop(std::unique_ptr<MeterJob> job);

    // Viewers that are not among these (ids, ascending) are forgotten.
    void stay(std::span<const uint32_t> viewers);
    // Another scene: everything is forgotten.
    void forget();
    // What is known now, by viewer and method: of pictures as accurate as the last ones.
    std::vector<ViewError> errors(Time now) const;
    // Appends the errors of single pixels of this viewer's pictures: of those from this pose that were drawn `with`
    // this, of the last half minute, the newest last. They are kept for jobs that say so, until one has another pose.
    void shown(uint32_t viewer, const Pose& pose, const DrawnWith& with, Time now,
               std::vector<gpu::ErrorDisc>& out) const;

private:
    struct Shown {
        Pose pose;
        struct Pixel {
            gpu::ErrorDisc disc;
            Time at;
            std::shared_ptr<const DrawnWith> with; // one for all pixels of a picture
        };
        std::deque<Pixel> pixels;
    };
    void keep(const MeterJob& job, std::span<const gpu::ErrorDisc> discs, Time now);
    void run(const std::stop_token& stop);
    void measure(const MeterJob& job, const std::stop_token& stop);

    const double share_;
    Time (*const clock_)();
    mutable std::mutex mutex_; // guards all below but the thread
    std::condition_variable_any given_;
    std::unique_ptr<MeterJob> free_, waiting_;
    bool busy_ = false;                 // True: a job is out, waits or is measured
    double credit_s_ = 0;               // CPU time that it may take now
    Time credited_{};                   // time up to which credit was given
    std::map<uint32_t, uint64_t> last_; // by viewer: number of its last job
    uint64_t jobs_ = 0, epoch_ = 0;     // epoch_: number of scenes that were forgotten
    // By viewer, method and accuracyOf() the law. So a finer plan, and finer pictures of cameras that rest, have
    // windows of their own.
    std::map<std::tuple<uint32_t, std::string, int>, ErrorWindow> windows_;
    std::map<uint32_t, Shown> shown_; // by viewer
    std::jthread thread_;             // the last member: it uses the others
};

// Pixels of a picture for one job: one at random in each of 16 x 16 parts of the rectangle that holds the box [lo, hi]
// as the eye sees it. Empty if it does not see it. `seed`: another one for each job.
std::vector<glm::uvec2> pixelsOf(const Pose& pose, glm::uvec2 size, glm::vec3 lo, glm::vec3 hi, uint64_t seed);

} // namespace brume
