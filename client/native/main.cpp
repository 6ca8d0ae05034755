// brume-client: one viewer of a brume server, in a window or without one.
#include <exception>
#include <iostream>
#include <optional>

#include "client/native/drawn_scene.h"
#include "client/native/film.h"
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
        if (options->film) return runFilm(*options, interrupt), 0;
        std::optional<DrawnScene> drawn;
        if (options->draw) drawn.emplace();
        Painter* const painter = drawn ? &*drawn : nullptr;
        options->headless ? runHeadless(*options, interrupt, painter) : runWindow(*options, interrupt, painter);
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "brume-client: " << error.what() << std::endl;
        return 1;
    }
}
