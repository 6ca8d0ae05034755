#include "tools/bench/page.h"

#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include <fmt/format.h>

#include "common/cores.h"

namespace brume::bench {
namespace {

// Where the costs are from, without the folder of their file: pages are read on other machines.
std::string sourceOf(const CostModel& model) {
    const size_t comma = model.source.find(", "), name = model.source.rfind('/');
    if (!model.calibrated || comma == model.source.npos || name == model.source.npos) return model.source;
    return model.source.substr(0, comma + 2) + model.source.substr(name + 1);
}

} // namespace

std::string said(const char* command) {
    std::string text(256, '\0');
    FILE* pipe = ::popen(command, "r");
    if (!pipe) return {};
    text.resize(std::fread(text.data(), 1, text.size(), pipe));
    ::pclose(pipe);
    return text.substr(0, text.find('\n'));
}

std::string cpu() {
    return said("lscpu | sed -n 's/^Model name: *//p'") + ", " + std::to_string(usableCores()) + " threads";
}

std::string today() {
    const std::time_t now = std::time(nullptr);
    char date[16];
    std::strftime(date, sizeof date, "%Y-%m-%d", std::gmtime(&now));
    return date;
}

std::string headed(const std::string& title, const Context& context, const gpu::Device& device,
                   const CostModel* costs) {
    return fmt::format("# {}\n\nWritten by `{}` on {}. CPU: {}. Vulkan device: {}, {}.{}\n\n", title, context.command,
                       today(), cpu(), device.name(), device.driver(),
                       costs ? fmt::format(" Costs: {}.", sourceOf(*costs)) : "");
}

void writeText(const std::filesystem::path& file, const std::string& text) {
    if (file.empty()) {
        std::cout << text;
        return;
    }
    std::filesystem::create_directories(file.parent_path().empty() ? "." : file.parent_path());
    std::ofstream out(file);
    out << text;
    if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
    std::cout << file.string() << '\n';
}

} // namespace brume::bench
