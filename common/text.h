// Text from outside the program, made safe to show.
#pragma once

#include <algorithm>
#include <string>

namespace brume {

// Replaces every control character by '?'. The result is one line and cannot control a terminal.
inline std::string oneLine(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, '?');
    return text;
}

} // namespace brume
