// A film of a camera's path: one still picture of the server for each frame, at whole size and within the scene's
// error.
#pragma once

#include "client/native/interrupt.h"
#include "client/native/options.h"

namespace brume::client {

// True: --out names a film ("turn.mp4") or numbered pictures ("turn-%04d.png"), not a folder.
bool isFilm(const std::filesystem::path& out);

// What is wrong with the options of a film, in one line; empty: nothing.
std::string problemOf(const Options& options);

// The name of a numbered picture: the run of digits that "%04d" or "%d" in the pattern asks for. Precondition: the
// pattern has one.
std::string numbered(const std::string& pattern, uint64_t number);

// Throws std::runtime_error, one line. `interrupt`: ends the film after the frame that is being made.
void runFilm(const Options& options, Interrupt& interrupt);

} // namespace brume::client
