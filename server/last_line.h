// The last line of a server that cannot go on, also where no memory is left for the usual way.
#pragma once

#include <exception>

namespace brume {

// What to tell people of an exception that ended the server: one line, which says what to do when memory is short.
// Valid as long as `error` is.
const char* lastLine(const std::exception& error);

// From now on an exception that no thread catches ends the process with one line and exit code 1. So does a fault in a
// library where the address space has a limit (ulimit -v): drivers do not check whether they get memory.
void endInOneLine();

} // namespace brume
