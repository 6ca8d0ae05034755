// Ranges of a program's options, which every program shows and refuses alike. It compiles CLI11.
#pragma once

#include <string>

#include <CLI/App.hpp>
#include <fmt/format.h>

namespace brume {

// Lets numbers from `least` to `most` through, ends included. The help says "NUMBER:1 to 64" of such an option, or its
// unit (the type name that is set, before or after) in place of NUMBER. The complaint says what is allowed.
template <class T>
CLI::Option* allow(CLI::Option* option, T least, T most) {
    const std::string kind = option->get_type_name();
    if (kind == "UINT" || kind == "INT" || kind == "FLOAT") option->type_name("NUMBER");
    const std::string range = fmt::format("{} to {}", least, most);
    const auto complaint = [option, range, inside = CLI::Range(least, most)](const std::string& text) -> std::string {
        if (inside(text).empty()) return {};
        const std::string shown = option->get_type_name(); // the unit or NUMBER, a colon, and the range
        const std::string unit = shown.starts_with("NUMBER:") ? "" : ' ' + shown.substr(0, shown.find(':'));
        return fmt::format("{} is not allowed here; allowed: {}{}", text, range, unit);
    };
    return option->check(CLI::Validator(complaint, range, {}));
}

} // namespace brume
