// Watching without a window: for tests, recordings and measurements.
#pragma once

#include "client/native/interrupt.h"
#include "client/native/options.h"
#include "client/native/recorder.h"

namespace brume::client {

// Runs until the frames or seconds asked for are over or the user interrupts. Statistics are printed and recorded in any case;
// then throws std::runtime_error, one line, when it ended for another reason.
void runHeadless(const Options& options, Interrupt& interrupt);

} // namespace brume::client
