// brume-client: one viewer of a brume server, in a window or without one.
#include <exception>
#include <iostream>

#include "client/native/headless.h"
#include "client/native/interrupt.h"
#include "client/native/options.h"
#include "client/native/window.h"

int main(int argc, char** argv) {
    using namespace brume::client;
    int exit_code = 0;
    const auto options = parseOptions(argc, argv, exit_code);
    if (!options) return exit_code;
    try {
        Interrupt interrupt;
        options->headless ? runHeadless(*options, interrupt) : runWindow(*options, interrupt);
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "brume-client: " << error.what() << std::endl;
        return 1;
    }
}
