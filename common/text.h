// Text from outside the program, made safe to show.
#pragma once

#include <algorithm>
#include <string>

namespace brume {

inline constexpr size_t kLongestLine = 2000; // bytes

// Replaces every control character by '?'. The result is one line and cannot control a terminal. Of a longer one than
// kLongestLine the middle is left out.
inline std::string oneLine(std::string text) {
    constexpr size_t kEnd = kLongestLine / 3;
    if (text.size() > kLongestLine) text.replace(kLongestLine - kEnd, text.size() - kLongestLine, " ... ");
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, '?');
    return text;
}

} // namespace brume
