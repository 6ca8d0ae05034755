// The page docs/scenes.md, made from the table of settings.
#pragma once

#include <string>

namespace brume {

// Markdown: every setting with its values, unit, default and help. Defaults are those of default-constructed structs.
std::string settingsPage();

} // namespace brume
