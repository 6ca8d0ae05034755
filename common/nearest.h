// The names that a misspelt one may mean.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace brume {

// "; did you mean A?", or "; did you mean A or B?" for the nearest of `names`. Empty when none is near. A name is near
// when at most a third of the word's letters, or one, is wrong. A word without its tables, such as "exposure" for
// "render.exposure", is near; so is the beginning of a name. A word over 64 bytes is near to nothing.
std::string didYouMean(std::string_view word, std::span<const std::string> names);

} // namespace brume
