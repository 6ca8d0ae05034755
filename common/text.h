// Text from outside, for people to read.
#pragma once

#include <algorithm>
#include <string>

namespace brume {

// With '?' for every control character: one line, that does nothing to a terminal.
inline std::string oneLine(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, '?');
    return text;
}

} // namespace brume
