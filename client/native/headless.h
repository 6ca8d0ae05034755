// The viewer without a window: for tests, recordings and measurements.
#pragma once

#include "client/native/interrupt.h"
#include "client/native/options.h"
#include "client/native/painter.h"
#include "client/native/recorder.h"

namespace brume::client {

// Runs until it has the frames or seconds that the options ask for, or the user interrupts. Always prints and records
// the statistics. Then throws std::runtime_error, one line, if it ended for another reason.
void runHeadless(const Options& options, Interrupt& interrupt, Painter* painter = nullptr);

} // namespace brume::client
