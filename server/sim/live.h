// Particles of a simulation elsewhere: messages set them, and they move evenly to what the last message said.
#pragma once

#include <vector>

#include "server/sim/motion.h"

namespace brume {

class Live final : public Motion {
public:
    // Without particles until a message sets some. Precondition: `columns` are new.
    Live(const Medium& medium, Columns& columns);

    void set(Columns& columns, const SetParticles& particles, const MotionStep& now) override;
    void step(Columns& columns, const MotionStep& step) override;
    // `extinction` is a factor, relative to the scene's own.
    void settle(Columns& columns, float extinction) override;
    std::array<Rows, 2> living() const override { return {Rows{0, live_}, Rows{}}; }
    std::span<const glm::vec3> albedos() const override { return albedos_; }
    std::optional<glm::vec3> source() const override { return centre_; }
    bool yields() const override { return false; }
    uint64_t history() const override { return told_; }
    uint64_t bytes() const override;
    void exchange(StateBytes& bytes, Columns& columns, const MotionStep& now) override;
    void restart() override;

private:
    // What a row moves to. A row's place now is in the home columns, its extinction in the column weight.
    struct Target {
        glm::vec3 place{0}; // m, relative to the volume
        float scale = 1, extinction = 0;
        glm::vec3 albedo{0};
        uint32_t left = 0; // steps until it is there
    };
    void place(Columns& columns, uint32_t row, const Target& at);
    void move(Columns& columns, uint32_t row);
    static void follow(Columns& columns, Rows rows, glm::vec3 volume);

    const glm::vec3 centre_, albedo_; // the scene's
    const float unit_;                // medium.extinction of the scene; 0: extinctions are never scaled
    uint32_t live_ = 0;
    uint32_t moving_ = 0; // steps until all rows are where they shall be
    uint64_t told_ = 0;   // a hash of all messages so far, and when they came
    std::vector<Target> targets_;
    std::vector<glm::vec3> albedos_;
};

} // namespace brume
