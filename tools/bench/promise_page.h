// The page of `brume-bench promise`: how often the promise is kept, and where it is not.
#pragma once

#include <span>
#include <string>

#include <nlohmann/json.hpp>

namespace brume::bench {

// Markdown from rows of promiseRow(): the whole, groups of scenes, the worst. budget, flip: as PromiseQuestion's.
std::string promisePage(std::span<const nlohmann::json> rows, double budget, double flip);
// The measured over the predicted error, as SVG.
std::string promisePlot(std::span<const nlohmann::json> rows);

} // namespace brume::bench
