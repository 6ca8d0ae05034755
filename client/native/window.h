// Watching in a window: the newest picture at once, the camera under the user's hand, reconnecting when the server goes away.
#pragma once

#include "client/native/interrupt.h"
#include "client/native/options.h"

namespace brume::client {

// Runs until the window is closed, the frames or seconds asked for are over, or the user interrupts. Statistics are printed
// and recorded in any case; then throws std::runtime_error, one line, when the server never let it in or the display failed.
void runWindow(const Options& options, Interrupt& interrupt);

} // namespace brume::client
