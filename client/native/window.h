// The viewer in a window: shows the newest picture, moves the camera as the user asks, and reconnects when the server
// goes away.
#pragma once

#include "client/native/interrupt.h"
#include "client/native/options.h"
#include "client/native/painter.h"

namespace brume::client {

// Runs until the window is closed, it has the frames or seconds that the options ask for, or the user interrupts.
// Always prints and records the statistics. Then throws std::runtime_error, one line, if the server never let it in
// or the display failed.
void runWindow(const Options& options, Interrupt& interrupt, Painter* painter = nullptr);

} // namespace brume::client
