#include "tools/bench/results_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace brume::bench {
namespace {

using nlohmann::json;

// Every number with five digits.
json rounded(const json& value) {
    json out = value;
    if (value.is_number_float() && std::isfinite(value.get<double>()))
        out = std::stod(fmt::format("{:.5g}", value.get<double>()));
    else if (value.is_structured())
        for (json& part : out) part = rounded(part);
    return out;
}

const json* named(const json& series, const json& name) {
    const auto same = [&](const json& one) { return one.at("name") == name; };
    const auto found = std::find_if(series.begin(), series.end(), same);
    return found == series.end() ? nullptr : &*found;
}

std::string lineOf(const json& object, const char* left_out) {
    json head = object;
    head.erase(left_out);
    const std::string text = rounded(head).dump();
    return text.substr(0, text.size() - 1); // without the last brace
}

} // namespace

json readResults(const std::filesystem::path& file) {
    std::ifstream in(file);
    json parsed = json::parse(in, nullptr, false);
    if (parsed.is_discarded())
        throw std::runtime_error(file.string() + ": no JSON; give the results that brume-bench sweep wrote");
    return parsed;
}

json merged(const json& before, const json& now) {
    json out = now, all = json::array();
    for (const json& old : before.at("series")) {
        const json* anew = named(now.at("series"), old.at("name"));
        all.push_back(anew ? *anew : old);
    }
    for (const json& one : now.at("series"))
        if (!named(before.at("series"), one.at("name"))) all.push_back(one);
    out["series"] = all;
    return out;
}

std::string textOf(const json& results) {
    std::string out = lineOf(results, "series") + ",\n\"series\": [\n";
    const json& all = results.at("series");
    for (size_t s = 0; s < all.size(); ++s) {
        out += lineOf(all[s], "rows") + ",\n\"rows\": [\n";
        const json& rows = all[s].at("rows");
        for (size_t r = 0; r < rows.size(); ++r)
            out += "  " + rounded(rows[r]).dump() + (r + 1 < rows.size() ? ",\n" : "\n");
        out += s + 1 < all.size() ? "]},\n" : "]}\n";
    }
    return out + "]}\n";
}

} // namespace brume::bench
