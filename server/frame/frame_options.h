// Options of the frame loop. They have their own header so that parsing options needs no Vulkan.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "server/error/error_window.h"
#include "server/plan/cost_model.h"
#include "server/sim/command.h"

namespace brume {

class DeviceTurns;
class Simulation;
struct Plan;

struct FrameOptions {
    unsigned batches = 3;            // batches in flight: one on the device, the others with the encoders
    double frame_ms = 50;            // budget for a frame of all viewers; above it accuracy is given up
    double most_frame_ms = 500;      // that a frame of all viewers may take: larger pictures are made smaller
    double measure_error = 0.02;     // part of one core that measures the error of pictures that are sent; 0: none
    double law_factor = 1;           // on the error of every law: not 1 where laws are wrong on purpose
    double refine_moving = 0.5;      // part of frame_ms for finer pictures while cameras rest and the medium moves
    uint64_t memory = 1024ull << 20; // most bytes of particles, on the CPU and on the device together
    // Most bytes of picture buffers: half of it for the targets, half for the planes of all batches.
    uint64_t picture_memory = 1024ull << 20;
    double lit_rate = 1000; // kB/s for a viewer who draws by itself, if an eighth of all messages is not more
    // True: FrameLoop::compiledWays() is filled by somebody, and what is not among them is not drawn.
    bool compiled_behind = false;
    uint64_t first_tick = 0; // of the state before the first tick
    CostModel costs = builtInCosts();
    bool learn_costs = true; // True: the times of passes correct `costs`
    // Called on the loop's thread with what was learnt: after some seconds, then every ten minutes.
    std::function<void(const CostModel&)> on_costs;
    // Called on the loop's thread ten times a second with the present tick, what is known of the pictures' errors, and
    // the plan.
    std::function<void(uint64_t, std::span<const ViewError>, const Plan&)> on_errors;
    // Called on the loop's thread before the first tick, and after every tick with the commands that it took.
    // `follows`: true after a tick; false for the first state, and for one that was loaded instead of the one before.
    std::function<void(const Simulation&, std::span<const Command>, bool follows)> ticked;
    DeviceTurns* turns = nullptr; // that share the device with other loops; null: it is this loop's alone
};

} // namespace brume
