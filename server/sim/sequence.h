// A simulation that was computed before: its files are shown one after another. Points with ids move from file to file.
// Of points with velocities one file fades into the next, and all are where they are at the moment.
#pragma once

#include <vector>

#include "server/sim/motion.h"
#include "server/sim/sequence_files.h"

namespace brume {

class Sequence final : public Motion {
public:
    // Shows the first file. Precondition: `columns` are new, with room for the largest file.
    Sequence(const Medium& medium, SequenceFiles files, Columns& columns);

    void step(Columns& columns, const MotionStep& step) override { show(columns, step.number, step.volume); }
    // `extinction` is a factor, relative to the scene's own, where the points have theirs.
    void settle(Columns& columns, float extinction) override;
    std::array<Rows, 2> living() const override { return {Rows{0, live_}, Rows{}}; }
    std::span<const glm::vec3> albedos() const override { return albedos_; }
    // Points of all files are numbered one after the other, and again in each round.
    uint64_t firstId() const override { return first_id_; }
    bool yields() const override { return false; }
    uint64_t history() const override { return files_.hash; }
    uint64_t bytes() const override;
    // All of it follows from the number of steps.
    void exchange(StateBytes& bytes, Columns& columns, const MotionStep& now) override {
        if (bytes.reads()) show(columns, now.number, now.volume);
    }
    void restart() override { turnTo(0), first_id_ = 0; }

private:
    struct Moment {
        size_t file = 0; // the one that is shown
        float part = 0;  // of the way to the next; 0 where points do not move
        float since = 0; // s, for which it is shown
        float left = 0;  // s, until the next
        uint64_t round = 0;
    };
    Moment at(uint64_t step) const;
    void turnTo(size_t file);
    void show(Columns& columns, uint64_t step, glm::vec3 volume);
    // Appends the points of a file as they are so many seconds after it, with a part of their extinction.
    void add(Columns& columns, const SequenceFile& file, float seconds, float part, glm::vec3 volume);

    const SequenceFiles files_;
    const double rate_;
    const bool loop_;
    const float unit_; // medium.extinction of the scene; 0: points' own extinctions are never scaled
    size_t present_ = 0;
    uint32_t live_ = 0;
    std::vector<uint64_t> before_; // points of the files before each, and at the end of all
    uint64_t first_id_ = 0;
    std::vector<uint32_t> next_; // of each row, the same point in the next file; kNone: it has none
    std::vector<glm::vec3> albedos_;
};

} // namespace brume
