// What an operator may set of the frame loop, apart from the loop so that reading it needs no Vulkan.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "server/plan/cost_model.h"
#include "server/sim/command.h"

namespace brume {

class Simulation;

struct FrameOptions {
    unsigned encode_threads = 2;
    unsigned batches = 3;            // one on the device, the others being encoded
    double frame_ms = 50;            // that a frame of all viewers may take before accuracy is given up
    double refine_moving = 0.5;      // part of frame_ms that finer pictures may take while cameras rest and the medium moves
    uint64_t memory = 1024ull << 20; // bytes that particles may take, on the CPU and on the device together
    CostModel costs = builtInCosts();
    // Called before the first tick and after every one, on the loop's thread, with the commands that it took.
    std::function<void(const Simulation&, std::span<const Command>)> ticked;
};

} // namespace brume
