// The tables of docs/scenes.md, made from the table of settings.
#pragma once

#include <string>

namespace brume {

// Markdown: a table for each table of a scene, below the line `<!-- settings: NAME -->`, "top" for the keys before any
// table. Every setting is there with its values, unit, default and help. Defaults are those of default-constructed
// structs.
std::string settingsTables();

} // namespace brume
